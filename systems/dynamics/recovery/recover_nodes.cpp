#include "systems/dynamics/recovery/recover_nodes.h"

#include <optional>

#include "systems/dynamics/recovery/surface_search.h"
#include "systems/material/material_law.h"

namespace skerry {

namespace {

class Recovery {
    using Terms = std::span<const RecoveryPlan::Term>;

    struct Value {
        Mat3 stress = Mat3::Zero(), strain = Mat3::Zero();
    };

public:
    Recovery(const RecoveryPlan& plan, const RecoveryState& body, decltype(&element_fields) compute_fields)
        : plan_(plan),
          body_(body),
          position_(body.position.subspan(static_cast<std::size_t>(body.first_node))),
          fields_(plan.center.size()) {
        compute_fields(body.elements, body.blocks, plan.block, body.position, fields_);
        sum_forces();
        std::vector<SurfaceSearch> searches;
        searches.reserve(plan.faces.size());
        for (std::size_t row = 0; row < plan.face_of_smooth_node.size(); ++row)
            if (plan.face_of_smooth_node[row] != no_index) searches.push_back(search_at(row));
        const std::vector<std::optional<Mat3>> gradients = surface_gradients(searches);
        smooth_values_.reserve(plan.face_of_smooth_node.size());
        for (std::size_t row = 0; row < plan.face_of_smooth_node.size(); ++row) {
            const auto f = static_cast<std::size_t>(plan.face_of_smooth_node[row]);
            if (plan.face_of_smooth_node[row] != no_index && gradients[f]) {
                const Mat3& F = *gradients[f];
                smooth_values_.push_back({stress(searches[f].material, F) * F.transpose() / F.determinant(),
                                          (F.transpose() * F - Mat3::Identity()) / 2});
            } else {
                smooth_values_.push_back(sum(plan.strained[row], plan.volumetric[row]));
            }
        }
    }

    /// Value at node `i` of the plan.
    Value at(std::size_t i) const {
        if (plan_.smooth_of[i] != no_index) return smooth_values_[static_cast<std::size_t>(plan_.smooth_of[i])];
        Value value = sum(plan_.strained_around[i], plan_.volumetric_around[i]);
        for (const auto [from, factor] : plan_.donors[i]) {
            const Value& donor = smooth_values_[static_cast<std::size_t>(from)];
            value.stress += factor * donor.stress;
            value.strain += factor * donor.strain;
        }
        return value;
    }

private:
    std::size_t block_of(std::size_t element) const {
        return static_cast<std::size_t>(body_.blocks.begin + plan_.block[element / element_lanes]);
    }

    /// For each node whose force is needed, computes the external force that would balance the elements around it [N].
    void sum_forces() {
        force_.assign(plan_.force_count, Vec3::Zero());
        for (const auto [at, corner, row] : plan_.corners) {
            const auto element = static_cast<std::size_t>(at);
            const std::size_t block = block_of(element), lane = element % element_lanes;
            const ElementGradient& gradient = body_.elements.nodes_of(block).gradient[corner];
            force_[static_cast<std::size_t>(row)] +=
                fields_[element].nominal_stress *
                (body_.elements.volume[block][lane] * Vec3(gradient[0][lane], gradient[1][lane], gradient[2][lane]));
        }
    }

    Value sum(Terms strained, Terms volumetric) const {
        Value value;
        for (const auto [element, factor] : strained) {
            const ElementFields& fields = fields_[static_cast<std::size_t>(element)];
            value.stress += factor * fields.cauchy_stress;
            value.strain += factor * fields.strain;
        }
        for (const auto [element, factor] : volumetric)
            value.stress += factor * fields_[static_cast<std::size_t>(element)].cauchy_stress;
        return value;
    }

    /// Arguments of the search for the deformation gradient at a surface node (docs/methods/elasticity.md 7.9). Its
    /// stress must balance the traction: the external force on the elements around the node, without weight and
    /// inertia, divided by the surface area.
    SurfaceSearch search_at(std::size_t row) const {
        const auto f = static_cast<std::size_t>(plan_.face_of_smooth_node[row]);
        const RecoveryPlan::Face& face = plan_.faces[f];
        const std::span<const Index> rows = plan_.force_rows[f];
        Vec3 force = force_[static_cast<std::size_t>(rows.front())], inner_force = Vec3::Zero();
        for (const Index inner : rows.subspan(1)) inner_force += force_[static_cast<std::size_t>(inner)];
        // weight and inertia, taken to be the same per volume as at the inner nodes nearby
        force -= face.inner_share * inner_force;
        const SurfaceAround& around = face.around;
        Vec3 start = Vec3::Zero();
        for (const auto [element, factor] : plan_.strained[row])
            start += fields_[static_cast<std::size_t>(element)].gradient * (factor * around.normal);
        return {body_.elements.whole_material_of(block_of(static_cast<std::size_t>(face.element))), &around,
                surface_stretch(plan_.triangles[f], position_), force / around.area.norm(), start};
    }

    const RecoveryPlan& plan_;
    const RecoveryState& body_;
    std::span<const Vec3> position_;     // nodes of the body [m]
    std::vector<ElementFields> fields_;  // by place
    std::vector<Vec3> force_;            // by row of a node whose force is needed [N]
    std::vector<Value> smooth_values_;   // by row of RecoveryPlan::face_of_smooth_node
};

}  // namespace

NodeFields recover_nodes(const RecoveryPlan& plan, const RecoveryState& body,
                         decltype(&element_fields) compute_fields) {
    const Recovery recovery(plan, body, compute_fields);
    NodeFields fields;
    fields.stress.reserve(plan.nodes.size());
    fields.strain.reserve(plan.nodes.size());
    fields.extrapolated.reserve(plan.nodes.size());
    for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
        const auto [stress, strain] = recovery.at(i);
        fields.stress.push_back(stress);
        fields.strain.push_back(strain);
        fields.extrapolated.push_back(plan.smooth_of[i] == no_index);
    }
    return fields;
}

}  // namespace skerry
