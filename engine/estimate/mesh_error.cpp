#include "engine/estimate/mesh_error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/estimate/energy_norm.h"
#include "engine/world/elements_of_body.h"
#include "engine/world/kernels.h"
#include "engine/world/world_state.h"
#include "skerry/estimate.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/kinds/element_list.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/material_law.h"

namespace skerry {

namespace {

/// Recovered stress (docs/methods/elasticity.md 7.9) at the corners of the tetrahedra of a body.
///
/// At edges and corners of the surface and at interfaces of materials, World::node_stress extrapolates, or mixes
/// materials. There, the class uses the volume-weighted mean stress of the tetrahedra of one material around the node,
/// which is more robust in thin walls.
class CornerStress {
public:
    CornerStress(const BodyRecord& record, const NodeFields& nodes, std::span<const Mat3> of_tetrahedra,
                 std::span<const Real> volume)
        : record_(record), nodes_(nodes), materials_(record.tetrahedron_material) {
        std::ranges::sort(materials_);
        materials_.erase(std::unique(materials_.begin(), materials_.end()), materials_.end());
        sums_.resize(nodes.stress.size() * std::max<std::size_t>(1, materials_.size()));
        for (std::size_t t = 0; t < volume.size(); ++t)
            for (std::size_t corner = 0; corner < 4; ++corner) {
                if (!nodes.extrapolated[static_cast<std::size_t>(record.tetrahedra[t][corner])]) continue;
                Sum& sum = sums_[sum_index(t, corner)];
                sum.stress += volume[t] * of_tetrahedra[t];
                sum.volume += volume[t];
            }
    }

    /// Mean of the recovered stress over the corners of a tetrahedron. In bodies of one material it uses the
    /// extrapolated values of World::node_stress.
    Mat3 mean(std::size_t tetrahedron) const {
        Mat3 sum = Mat3::Zero();
        for (std::size_t corner = 0; corner < 4; ++corner)
            sum += materials_.size() > 1 ? stress_at(tetrahedron, corner) : nodes_.stress[node_at(tetrahedron, corner)];
        return sum / 4;
    }
    Mat3 stress_at(std::size_t tetrahedron, std::size_t corner) const {
        const std::size_t n = node_at(tetrahedron, corner);
        if (!nodes_.extrapolated[n]) return nodes_.stress[n];
        const Sum& sum = sums_[sum_index(tetrahedron, corner)];
        return sum.stress / sum.volume;
    }

private:
    struct Sum {
        Mat3 stress = Mat3::Zero();  // sum of stress times volume
        Real volume = 0;
    };

    std::size_t node_at(std::size_t tetrahedron, std::size_t corner) const {
        return static_cast<std::size_t>(record_.tetrahedra[tetrahedron][corner]);
    }
    std::size_t sum_index(std::size_t tetrahedron, std::size_t corner) const {
        const std::size_t n = node_at(tetrahedron, corner);
        if (materials_.empty()) return n;
        const auto material = std::ranges::lower_bound(materials_, record_.tetrahedron_material[tetrahedron]);
        return n + nodes_.stress.size() * static_cast<std::size_t>(material - materials_.begin());
    }

    const BodyRecord& record_;
    const NodeFields& nodes_;
    std::vector<Index> materials_;  // materials of the body, ascending; empty if there is only one
    std::vector<Sum> sums_;         // by material and node
};

Real sum(std::span<const Real> values) {
    return std::accumulate(values.begin(), values.end(), Real{0});
}

/// Square of a relative error (Zienkiewicz and Zhu 1987, equation 30). `error`, `energy`: squared energy norms of the
/// error of a stress, and of the stress itself.
Real share_of(Real error, Real energy) {
    return error > 0 ? error / (error + energy) : 0;
}

/// Sums over the elements and tetrahedra of a body. They give, for example, the missing energy: the energy that an
/// infinitely fine mesh would store in addition under the same loads (docs/methods/error_estimates.md 1).
///
/// Smoothed elements solve for a stress s, constant in each element, and for displacements with the strain e in the
/// tetrahedra. Let s* be the exact stress, S and S* the strains that the material law gives for s and s*. The missing
/// energy is the error of the functional of Hellinger and Reissner. The error is of second order, because s and the
/// displacements make the functional stationary:
///     missing energy = integral of 2 (S - e) : (s* - s) + (s* - s) : (S* - S) over the body
///
/// The recovered stress is used in place of s*. For linear tetrahedra S = e, and the missing energy is the squared norm
/// of the error.
class MeshErrorSum {
public:
    MeshErrorSum(const Model& model, std::size_t body)
        : body_(model, body),
          record_(model.body_records[body]),
          rest_(rows_of(model.nodes.rest_position, model.bodies.nodes[body])),
          norms_(model.materials.constants.size()) {
        error_.nodes = body_.node_fields(all_nodes(model, body));
        error_.of_nodes.resize(rest_.size());
        if (body_.blocks.size() > 0) compare();
        body_.turn(error_.nodes.stress);
        body_.turn(error_.nodes.strain);
    }

    MeshError take() { return std::move(error_); }

private:
    void compare() {
        const std::size_t count = record_.tetrahedra.size();
        for (std::vector<Real>* column : {&error_.volume, &error_.energy, &error_.error}) column->resize(count);
        find_blocks(count);
        std::vector<Mat3> of_elements(static_cast<std::size_t>(body_.blocks.size()) * element_lanes);
        kernels().cauchy_stress(body_.elements, body_.blocks, body_.position, of_elements);
        for (std::size_t t = 0; t < count; ++t) error_.volume[t] = six_volumes(record_.tetrahedra[t], rest_) / 6;
        if (!add_elements(of_elements)) return;
        const std::vector<Mat3> of_tetrahedra = kernels().stress_of_tetrahedra(body_.cover, of_elements, count);
        const CornerStress recovered(record_, error_.nodes, of_tetrahedra, error_.volume);
        for (std::size_t t = 0; t < count; ++t) add_tetrahedron(t, of_tetrahedra[t], recovered);
        error_.stored += sum(error_.energy);
        // The missing energy is the energy of the exact stress minus the stored energy. The recovered stress, times the
        // factor stored / mixed_, is used in place of the exact stress.
        //
        // mixed_ is the integral of the recovered stress times the strain of the displacements. For the exact stress,
        // which is in balance with the loads, this integral is the stored energy, and the factor gives the recovered
        // stress the same property.
        if (mixed_ > 0) error_.missing = error_.stored * (error_.stored * recovered_ / (mixed_ * mixed_) - 1);
        find_peak(of_tetrahedra, recovered);
        find_interpolation_error();
        find_errors_of_nodes();
    }
    std::size_t block_at(std::size_t element) const {
        return static_cast<std::size_t>(body_.blocks.begin) + element / element_lanes;
    }
    const MaterialConstants& constants_of(std::size_t block) const {
        return body_.elements.constants[static_cast<std::size_t>(body_.elements.material[block])];
    }
    bool is_anisotropic(std::size_t block) const { return constants_of(block).model == MaterialModel::orthotropic; }

    /// Writes block_ and splits_.
    /// - block_: for each tetrahedron, the block (a group of elements of one kind that are computed together) of an
    ///   element that covers it. Inversion barriers, and elements with the volumetric stress alone, do not count.
    /// - splits_: true for materials of which some elements carry only the volumetric stress.
    void find_blocks(std::size_t tetrahedron_count) {
        block_.resize(tetrahedron_count);
        splits_.resize(norms_.size());
        for (std::size_t element = 0; element < body_.cover.tetrahedra.size(); ++element) {
            const std::size_t block = block_at(element);
            const ElementPart part = body_.elements.part[block];
            if (part == ElementPart::volume) splits_[static_cast<std::size_t>(body_.elements.material[block])] = true;
            if (part == ElementPart::volume || part == ElementPart::guard) continue;
            for (const Index t : body_.cover.tetrahedra[element]) block_[static_cast<std::size_t>(t)] = block;
        }
    }

    const EnergyNorm& norm_of(std::size_t block) {
        const auto material = static_cast<std::size_t>(body_.elements.material[block]);
        std::optional<EnergyNorm>& norm = norms_[material];
        if (!norm || is_anisotropic(block))  // the axes of an anisotropic material may vary
            norm.emplace(body_.elements.whole_material_of(block), splits_[material]);
        return *norm;
    }

    /// Adds to error_.stored the energy of the elements minus the energy of their mean stresses in the tetrahedra.
    /// compare() later adds error_.energy, the energy of the stresses of the tetrahedra, which consist of these means;
    /// the sum is the energy of the elements. Returns false if the elements are not strained.
    bool add_elements(std::span<const Mat3> stress) {
        constexpr Real smallest_strain = 1e-9;  // smaller mean strains are rounding errors, for example in free fall
        struct Mean {
            StressCoordinates sum = StressCoordinates::Zero();
            Real count = 0;
        };
        // by tetrahedron: mean stresses of its elements, [1] of those with volumetric stress only, [0] of the others
        std::array<std::vector<Mean>, 2> means;
        for (std::vector<Mean>& list : means) list.resize(error_.volume.size());
        Real stiffness = 0;
        for (std::size_t element = 0; element < body_.cover.tetrahedra.size(); ++element) {
            const std::span<const Index> covered = body_.cover.tetrahedra[element];
            if (covered.empty()) continue;
            const std::size_t block = block_at(element);
            const ElementPart part = body_.elements.part[block];
            const Mat3 turn = is_anisotropic(block) ? turn_of(gradient_of(static_cast<std::size_t>(covered.front())))
                                                    : Mat3(Mat3::Identity());
            const StressCoordinates coordinates = norm_of(block).of(stress[element], part, turn);
            const Real volume = body_.elements.volume[block][element % element_lanes];
            error_.stored += volume * coordinates.squaredNorm();
            stiffness += volume * constants_of(block).shear_modulus;
            for (const Index t : covered) {
                Mean& mean = means[part == ElementPart::volume ? 1 : 0][static_cast<std::size_t>(t)];
                mean.sum += coordinates;
                ++mean.count;
            }
        }
        if (error_.stored < smallest_strain * smallest_strain * stiffness) {
            error_.stored = 0;
            return false;
        }
        for (const std::vector<Mean>& list : means)
            for (std::size_t t = 0; t < list.size(); ++t)
                if (list[t].count > 0) error_.stored -= error_.volume[t] * (list[t].sum / list[t].count).squaredNorm();
        return true;
    }

    /// Edge vectors of a tetrahedron, as columns.
    Mat3 edges_of(std::size_t tetrahedron, std::span<const Vec3> position, Index first_node) const {
        const std::array<Index, 4>& node = record_.tetrahedra[tetrahedron];
        const auto at = [&](std::size_t k) -> const Vec3& {
            return position[static_cast<std::size_t>(node[k] + first_node)];
        };
        Mat3 edges;
        edges << at(1) - at(0), at(2) - at(0), at(3) - at(0);
        return edges;
    }
    Mat3 gradient_of(std::size_t tetrahedron) const {
        return edges_of(tetrahedron, body_.position, body_.first_node) * edges_of(tetrahedron, rest_, 0).inverse() *
               body_.built.transpose();
    }
    static Mat3 turn_of(const Mat3& F) {
        const std::array<Real, 4> q = nearest_rotation(F, {1, 0, 0, 0});
        return Eigen::Quaternion<Real>(q[0], q[1], q[2], q[3]).toRotationMatrix();
    }

    void add_tetrahedron(std::size_t t, const Mat3& of_elements, const CornerStress& recovered) {
        const std::size_t block = block_[t];
        const EnergyNorm& norm = norm_of(block);
        const Mat3 F = gradient_of(t);
        const Mat3 turn = is_anisotropic(block) ? turn_of(F) : Mat3(Mat3::Identity());
        const auto coordinates = [&](const Mat3& stress) { return norm.of(stress, ElementPart::whole, turn); };
        const StressCoordinates own = coordinates(of_elements);
        // The integral of the product of linear functions a and b is V/20 (sum of a_i b_i + (sum of a_i)(sum of b_i)),
        // with the corner values a_i and b_i.
        Real error = 0, energy = 0;
        StressCoordinates total = StressCoordinates::Zero();
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const StressCoordinates at = coordinates(recovered.stress_at(t, corner));
            error += (at - own).squaredNorm();
            energy += at.squaredNorm();
            total += at;
        }
        const Real volume = error_.volume[t];
        error_.energy[t] = volume * own.squaredNorm();
        error_.error[t] = volume / 20 * (error + (total - 4 * own).squaredNorm());
        recovered_ += volume / 20 * (energy + total.squaredNorm());
        if (const Real J = F.determinant(); J != 0)
            mixed_ +=
                volume / 4 *
                coordinates(skerry::stress(body_.elements.whole_material_of(block), F) * F.transpose() / std::abs(J))
                    .dot(total);
    }

    /// Estimates the error of the largest recovered stress: the difference between recovered stress and stress of the
    /// tetrahedra, as root mean square over the tetrahedra around the node with the largest stress. Both are taken at
    /// centroids, where they have errors of second order in the length of the edges.
    void find_peak(std::span<const Mat3> of_tetrahedra, const CornerStress& recovered) {
        Index peak = 0;
        for (std::size_t n = 0; n < error_.nodes.stress.size(); ++n) {
            const Real stress = von_mises(error_.nodes.stress[n]);
            if (!(stress > error_.largest_stress)) continue;
            error_.largest_stress = stress;
            peak = static_cast<Index>(n);
        }
        if (!(error_.largest_stress > 0)) return;
        Real squares = 0, volume = 0;
        for (std::size_t t = 0; t < of_tetrahedra.size(); ++t) {
            if (std::ranges::count(record_.tetrahedra[t], peak) == 0) continue;
            const Real difference = von_mises(recovered.mean(t) - of_tetrahedra[t]);
            squares += error_.volume[t] * difference * difference;
            volume += error_.volume[t];
        }
        error_.stress = std::min<Real>(1, std::sqrt(squares / volume) / error_.largest_stress);
    }

    /// Along an edge of length L, a displacement whose strain goes linearly between the recovered strains of the ends
    /// differs from the linear displacement by up to L/8 times the difference of these strains.
    void find_interpolation_error() {
        Real squares = 0;
        for (std::size_t t = 0; t < record_.tetrahedra.size(); ++t)
            for (std::size_t i = 0; i < 4; ++i)
                for (std::size_t j = 0; j < i; ++j) {
                    const auto a = static_cast<std::size_t>(record_.tetrahedra[t][i]);
                    const auto b = static_cast<std::size_t>(record_.tetrahedra[t][j]);
                    const Mat3 difference = error_.nodes.strain[a] - error_.nodes.strain[b];
                    squares += error_.volume[t] / 6 * (rest_[a] - rest_[b]).squaredNorm() * difference.squaredNorm();
                }
        error_.interpolation = std::sqrt(squares / sum(error_.volume)) / 8;
    }

    void find_errors_of_nodes() {
        const std::vector<Real> relative = error_.relative_errors();
        std::vector<Real> count(rest_.size());
        for (std::size_t t = 0; t < relative.size(); ++t)
            for (const Index n : record_.tetrahedra[t]) {
                error_.of_nodes[static_cast<std::size_t>(n)] += relative[t];
                ++count[static_cast<std::size_t>(n)];
            }
        for (std::size_t n = 0; n < count.size(); ++n)
            if (count[n] > 0) error_.of_nodes[n] /= count[n];
    }

    const ElementsOfBody body_;
    const BodyRecord& record_;
    std::span<const Vec3> rest_;                    // nodes of the body in the frame of the mesh [m]
    std::vector<std::optional<EnergyNorm>> norms_;  // by material
    std::vector<bool> splits_;                      // by material
    std::vector<std::size_t> block_;                // by tetrahedron
    // `recovered_`: integral of the recovered stress times its strain. `mixed_`: integral of the recovered stress times
    // the strain of the displacements [J].
    Real recovered_ = 0, mixed_ = 0;
    MeshError error_;
};

}  // namespace

Real MeshError::mesh() const {
    return std::sqrt(share_of(sum(error), sum(energy)));
}

Real MeshError::deflection() const {
    const Real whole = stored + missing;
    return whole > 0 ? missing / whole : 0;
}

std::vector<Real> MeshError::relative_errors() const {
    const Real mean = (sum(energy) + sum(error)) / sum(volume);
    std::vector<Real> relative(error.size());
    for (std::size_t t = 0; t < error.size(); ++t)
        if (error[t] > 0) relative[t] = std::sqrt(error[t] / (volume[t] * mean));
    return relative;
}

MeshError measure_mesh_error(const World& world, BodyHandle body) {
    const Model& model = WorldAccess::state_of(world).model;
    return MeshErrorSum(model, static_cast<std::size_t>(model.row(body, "mesh_error"))).take();
}

std::vector<Real> mesh_error(const World& world, BodyHandle body) {
    return measure_mesh_error(world, body).relative_errors();
}

}  // namespace skerry
