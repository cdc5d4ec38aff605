#include "systems/dynamics/recovery/recover_nodes.h"

#include <optional>

#include "systems/dynamics/recovery/polynomial_fit.h"
#include "systems/material/material_law.h"

namespace skerry {

namespace {

constexpr int tensor_entries = 9;
using Pair = Eigen::Matrix<Real, 1, 2 * tensor_entries>;  // stress, then strain

Mat3 green_strain(const Mat3& F) {
    return (F.transpose() * F - Mat3::Identity()) / 2;
}

Pair pair_of(const Mat3& stress, const Mat3& strain) {
    Pair pair;
    pair << stress.reshaped().transpose(), strain.reshaped().transpose();
    return pair;
}

class Recovery {
public:
    Recovery(const RecoveryPlan& plan, const RecoveryState& body, decltype(&element_fields) of_blocks)
        : plan_(plan),
          body_(body),
          position_(body.position.subspan(static_cast<std::size_t>(body.first_node))),
          fields_(plan.center.size()) {
        of_blocks(body.elements, body.blocks, plan.block, body.position, fields_);
        sample_.reserve(fields_.size());
        for (const ElementFields& of : fields_) sample_.push_back(pair_of(of.cauchy_stress, green_strain(of.gradient)));
        sum_forces();
        at_smooth_.reserve(plan.smooth.size());
        for (std::size_t row = 0; row < plan.smooth.size(); ++row)
            at_smooth_.push_back(plan.smooth[row].face == no_index ? fitted(row) : at_face(row));
    }

    Pair at(const RecoveryPlan::Value& value) const {
        return value.smooth == no_index ? extrapolated(value) : at_smooth_[static_cast<std::size_t>(value.smooth)];
    }

private:
    std::size_t block_of(std::size_t place) const {
        return static_cast<std::size_t>(body_.blocks.begin + plan_.block[place / element_lanes]);
    }
    Real volume(std::size_t place) const { return body_.elements.volume[block_of(place)][place % element_lanes]; }

    /// For each node that needs it, computes the external force that would balance the elements around the node [N].
    void sum_forces() {
        const RaggedView<RecoveryPlan::Corner> corners = plan_.corners.view();
        force_.assign(corners.size(), Vec3::Zero());
        for (std::size_t row = 0; row < force_.size(); ++row)
            for (const auto [at, corner] : corners[row]) {
                const auto place = static_cast<std::size_t>(at);
                const std::size_t lane = place % element_lanes;
                const ElementGradient& of = body_.elements.nodes_of(block_of(place)).gradient[corner];
                const Mat3 Q = volume(place) * fields_[place].nominal_stress;
                force_[row] += Q * Vec3(of[0][lane], of[1][lane], of[2][lane]);
            }
    }

    Pair fitted(std::size_t row) const {
        const RecoveryPlan::SmoothNode& node = plan_.smooth[row];
        const auto at = [&](std::size_t p) -> Vec3 { return (plan_.center[p] - node.rest) / node.size; };
        const auto fit = [&](auto&& polynomial) {
            for (const Index place : plan_.strained[row]) {
                const auto p = static_cast<std::size_t>(place);
                polynomial.add(volume(p), at(p), sample_[p]);
            }
            int rank = 0;
            return polynomial.at_origin(rank);
        };
        Pair sum = node.is_quadratic ? fit(PolynomialFit<quadratic_terms, 2 * tensor_entries>())
                                     : fit(PolynomialFit<linear_terms, 2 * tensor_entries>());
        PolynomialFit<linear_terms, tensor_entries> volumetric;
        for (const Index place : plan_.volumetric[row]) {
            const auto p = static_cast<std::size_t>(place);
            volumetric.add(volume(p), at(p), sample_[p].head<tensor_entries>());
        }
        int rank = 0;
        sum.head<tensor_entries>() += volumetric.at_origin(rank);
        return sum;
    }

    Pair at_face(std::size_t row) const {
        const auto f = static_cast<std::size_t>(plan_.smooth[row].face);
        const auto place = static_cast<std::size_t>(plan_.faces[f].place);
        const MaterialConstants material = body_.elements.whole_material_of(block_of(place));
        if (const std::optional<Mat3> F = gradient_at(f, plan_.strained[row], material))
            return pair_of(stress(material, *F) * F->transpose() / F->determinant(), green_strain(*F));
        return mean(plan_.strained[row], plan_.volumetric[row]);
    }

    /// Deformation gradient at the surface node of face `f`, with a stress that balances the traction. The traction is
    /// the external force on the elements around the node, divided by the surface area. The part of the force that is
    /// due to weight and inertia is subtracted first. Per volume, this part is taken to be the same as at the inner
    /// nodes nearby.
    std::optional<Mat3> gradient_at(std::size_t f, std::span<const Index> strained,
                                    const MaterialConstants& material) const {
        const RecoveryPlan::Face& face = plan_.faces[f];
        const std::span<const Index> rows = plan_.force[f];
        Vec3 force = force_[static_cast<std::size_t>(rows.front())], inner_force = Vec3::Zero();
        for (const Index inner : rows.subspan(1)) inner_force += force_[static_cast<std::size_t>(inner)];
        force -= face.inner_share * inner_force;
        Mat3 F = Mat3::Zero();
        Real whole = 0;
        for (const Index place : strained) {
            const auto p = static_cast<std::size_t>(place);
            F += volume(p) * fields_[p].gradient;
            whole += volume(p);
        }
        const SurfaceAround& around = face.around;
        return surface_gradient(material, around, surface_stretch(plan_.triangles[f], position_),
                                force / around.area.norm(), F * around.normal / whole);
    }

    /// Mean over the given elements, for each part of the stress.
    Pair mean(std::span<const Index> strained, std::span<const Index> volumetric) const {
        Pair sum = Pair::Zero();
        Real whole = 0;
        for (const Index place : strained) {
            const auto p = static_cast<std::size_t>(place);
            sum += volume(p) * sample_[p];
            whole += volume(p);
        }
        if (whole > 0) sum /= whole;
        Eigen::Matrix<Real, 1, tensor_entries> stress = Eigen::Matrix<Real, 1, tensor_entries>::Zero();
        Real whole_volumetric = 0;
        for (const Index place : volumetric) {
            const auto p = static_cast<std::size_t>(place);
            stress += volume(p) * sample_[p].head<tensor_entries>();
            whole_volumetric += volume(p);
        }
        if (whole_volumetric > 0) sum.head<tensor_entries>() += stress / whole_volumetric;
        return sum;
    }

    Pair extrapolated(const RecoveryPlan::Value& value) const {
        Pair sum = Pair::Zero();
        Real whole = 0;
        for (Index e = value.extrapolations.begin; e < value.extrapolations.end; ++e) {
            const auto row = static_cast<std::size_t>(e);
            const Real share = plan_.extrapolations[row].volume;
            sum += share * extrapolated(row, value.rest);
            whole += share;
        }
        if (whole > 0) sum /= whole;
        return sum;
    }
    Pair extrapolated(std::size_t row, const Vec3& rest) const {
        const RecoveryPlan::Extrapolation& of = plan_.extrapolations[row];
        if (!of.is_determined) return mean(plan_.strained_around[row], plan_.volumetric_around[row]);
        PolynomialFit<linear_terms, 2 * tensor_entries> fit;
        for (const Index donor : plan_.donors[row]) {
            const auto d = static_cast<std::size_t>(donor);
            fit.add(1, (plan_.smooth[d].rest - rest) / of.size, at_smooth_[d]);
        }
        int rank = 0;
        return fit.at_origin(rank);
    }

    const RecoveryPlan& plan_;
    const RecoveryState& body_;
    std::span<const Vec3> position_;     // nodes of the body [m]
    std::vector<ElementFields> fields_;  // by place
    std::vector<Pair> sample_;           // by place
    std::vector<Vec3> force_;            // by row of RecoveryPlan::corners [N]
    std::vector<Pair> at_smooth_;        // by row of RecoveryPlan::smooth
};

}  // namespace

NodeFields recover_nodes(const RecoveryPlan& plan, const RecoveryState& body, decltype(&element_fields) of_blocks) {
    const Recovery recovery(plan, body, of_blocks);
    NodeFields fields;
    fields.stress.reserve(plan.values.size());
    fields.strain.reserve(plan.values.size());
    for (const RecoveryPlan::Value& value : plan.values) {
        const Pair of_node = recovery.at(value);
        fields.stress.push_back(of_node.head<tensor_entries>().reshaped(3, 3));
        fields.strain.push_back(of_node.tail<tensor_entries>().reshaped(3, 3));
    }
    return fields;
}

}  // namespace skerry
