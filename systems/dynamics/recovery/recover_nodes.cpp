#include "systems/dynamics/recovery/recover_nodes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "systems/dynamics/recovery/node_patches.h"
#include "systems/dynamics/recovery/polynomial_fit.h"
#include "systems/dynamics/recovery/surface_gradient.h"
#include "systems/material/material_law.h"

namespace skerry {

namespace {

constexpr int tensor_entries = 9;
using Pair = Eigen::Matrix<Real, 1, 2 * tensor_entries>;  // stress, then strain

struct Fields {
    Mat3 stress, strain;
};

Pair pair_of(const Fields& fields) {
    Pair pair;
    pair << fields.stress.reshaped().transpose(), fields.strain.reshaped().transpose();
    return pair;
}
Fields fields_of(const Pair& pair) {
    return {pair.head<tensor_entries>().reshaped(3, 3), pair.tail<tensor_entries>().reshaped(3, 3)};
}

Mat3 green_strain(const Mat3& F) {
    return (F.transpose() * F - Mat3::Identity()) / 2;
}

class Recovery {
public:
    Recovery(const RecoveryInputs& body, std::span<const Index> nodes, decltype(&element_fields) of_blocks)
        : body_(body),
          rest_(body.rest_position.begin(), body.rest_position.end()),
          patches_(body.tetrahedra, body.surface, body.material_of_tetrahedra, body.rest_position),
          wanted_(body.rest_position.size()),
          near_(body.tetrahedra.size()) {
        turn_rest();
        position_ = body.position.subspan(static_cast<std::size_t>(body.first_node), rest_.size());
        for (const Index n : nodes) want(n);
        near_elements_ = ElementsNear(body.cover, near_);
        fields_.resize(near_elements_.block.size() * element_lanes);
        of_blocks(body.elements, body.blocks, near_elements_.block, body.position, fields_);
        place_elements();
        sum_forces();
        at_node_.resize(rest_.size());
        for (std::size_t n = 0; n < rest_.size(); ++n)
            if (wanted_[n] != 0) at_node_[n] = smooth_fields(static_cast<Index>(n));
    }

    Fields at(Index n) const {
        return patches_.kind(n) == NodeKind::other ? extrapolated(n) : at_node_[static_cast<std::size_t>(n)];
    }

private:
    /// Turns the rest positions into the frame of the gradients. These were turned with the body when it was added, and
    /// the deformation gradient of the rest shape is the inverse of that rotation.
    void turn_rest() {
        for (Index b = body_.blocks.begin; b < body_.blocks.end; ++b) {
            const auto block = static_cast<std::size_t>(b);
            if (!(body_.elements.volume[block][0] > 0)) continue;
            const BlockNodes nodes = body_.elements.nodes_of(block);
            const auto rest = [&](Index k) -> const Vec3& {
                return body_.rest_position[static_cast<std::size_t>(nodes.node[k][0] - body_.first_node)];
            };
            Mat3 turn = Mat3::Zero();
            for (Index k = 1; k < nodes.count; ++k) turn += gradient(nodes, k, 0) * (rest(k) - rest(0)).transpose();
            for (Vec3& x : rest_) x = turn * x;
            return;
        }
    }

    static Vec3 gradient(const BlockNodes& nodes, Index k, std::size_t lane) {
        const ElementGradient& of = nodes.gradient[k];
        return {of[0][lane], of[1][lane], of[2][lane]};
    }

    /// Marks the nodes and tetrahedra on which the value at a node depends.
    void want(Index n) {
        mark_around(n);
        if (patches_.kind(n) != NodeKind::other) return want_smooth(n);
        for (const Index material : patches_.materials_around(n))
            for (const Index donor : patches_.donors(n, material)) want_smooth(donor);
    }
    void want_smooth(Index n) {
        if (std::exchange(wanted_[static_cast<std::size_t>(n)], std::uint8_t{1}) != 0) return;
        mark_around(n);
        if (patches_.kind(n) == NodeKind::face)
            for (const Index inner : patches_.inner_neighbours(n)) mark_around(inner);
    }
    void mark_around(Index n) {
        for (const Index t : patches_.tetrahedra(n)) near_[static_cast<std::size_t>(t)] = 1;
    }

    std::size_t block_of(std::size_t place) const {
        return static_cast<std::size_t>(body_.blocks.begin + near_elements_.block[place / element_lanes]);
    }
    Real volume(std::size_t place) const { return body_.elements.volume[block_of(place)][place % element_lanes]; }

    /// Centroid of the tetrahedra that each element covers.
    void place_elements() {
        centre_.assign(fields_.size(), Vec3::Zero());
        for (std::size_t place = 0; place < fields_.size(); ++place) {
            Real sum = 0;
            for (const Index t : near_elements_.covered(body_.cover, place)) {
                const Real share = patches_.volume(t);
                sum += share;
                for (const Index n : body_.tetrahedra[static_cast<std::size_t>(t)])
                    centre_[place] += share / 4 * rest_[static_cast<std::size_t>(n)];
            }
            if (sum > 0) centre_[place] /= sum;
        }
    }

    /// External forces with which the elements would be at rest [N]. They are complete at the nodes all of whose
    /// tetrahedra are near.
    void sum_forces() {
        force_.assign(rest_.size(), Vec3::Zero());
        for (std::size_t place = 0; place < fields_.size(); ++place) {
            if (near_elements_.covered(body_.cover, place).empty()) continue;
            const BlockNodes nodes = body_.elements.nodes_of(block_of(place));
            const std::size_t lane = place % element_lanes;
            const Mat3 Q = volume(place) * fields_[place].nominal_stress;
            for (Index k = 0; k < nodes.count; ++k)
                force_[static_cast<std::size_t>(nodes.node[k][lane] - body_.first_node)] +=
                    Q * gradient(nodes, k, lane);
        }
    }

    Fields smooth_fields(Index n) const {
        const std::vector<Index> places = near_elements_.around(patches_.tetrahedra(n));
        if (patches_.kind(n) == NodeKind::inner) return fitted(n, places);
        const Index row = body_.elements.material[block_of(static_cast<std::size_t>(places.front()))];
        const MaterialConstants& material = body_.elements.constants[static_cast<std::size_t>(row)];
        if (const std::optional<Mat3> F = gradient_at_surface(n, places, material))
            return {stress(material, *F) * F->transpose() / F->determinant(), green_strain(*F)};
        return mean(places, patches_.material(n));
    }

    bool has_strain(std::size_t place) const { return body_.elements.part[block_of(place)] != ElementPart::volume; }

    Fields fitted(Index n, std::span<const Index> places) const {
        // Stresses of single tetrahedra scatter too much for a quadratic fit, which has two samples or more per term.
        constexpr int enough = 2 * quadratic_terms;
        Real size = 0;
        int count = 0;
        bool smoothed = false;
        const auto offset = [&](std::size_t p) -> Vec3 { return centre_[p] - rest_[static_cast<std::size_t>(n)]; };
        for (const Index place : places) {
            const auto p = static_cast<std::size_t>(place);
            size = std::max(size, offset(p).norm());
            if (!has_strain(p)) continue;
            ++count;
            smoothed = smoothed || near_elements_.covered(body_.cover, p).size() > 1;
        }
        const bool is_quadratic = smoothed && count >= enough;
        if (!(size > 0)) size = 1;
        PolynomialFit<quadratic_terms, 2 * tensor_entries> quadratic;
        PolynomialFit<linear_terms, 2 * tensor_entries> linear;
        PolynomialFit<linear_terms, tensor_entries> volumetric;
        for (const Index place : places) {
            const auto p = static_cast<std::size_t>(place);
            const Vec3 at = offset(p) / size;
            if (!has_strain(p))
                volumetric.add(volume(p), at, fields_[p].cauchy_stress.reshaped().transpose());
            else if (is_quadratic)
                quadratic.add(volume(p), at, sample(p));
            else
                linear.add(volume(p), at, sample(p));
        }
        int rank = 0;
        Pair sum = is_quadratic ? quadratic.at_origin(rank) : linear.at_origin(rank);
        sum.head<tensor_entries>() += volumetric.at_origin(rank);
        return fields_of(sum);
    }

    Pair sample(std::size_t place) const {
        return pair_of({fields_[place].cauchy_stress, green_strain(fields_[place].gradient)});
    }

    /// Traction that the elements around a surface node balance. Inner nodes around give the force per volume, of
    /// weight and inertia, that the elements of the surface node balance as well.
    std::optional<Mat3> gradient_at_surface(Index n, std::span<const Index> places,
                                            const MaterialConstants& material) const {
        const SurfaceAround around = surface_around(body_.surface, patches_.triangles(n), rest_, position_);
        Vec3 inner_force = Vec3::Zero();
        Real inner_volume = 0;
        for (const Index inner : patches_.inner_neighbours(n)) {
            inner_force += force_[static_cast<std::size_t>(inner)];
            inner_volume += patches_.node_volume(inner);
        }
        Vec3 force = force_[static_cast<std::size_t>(n)];
        if (inner_volume > 0) force -= patches_.node_volume(n) / inner_volume * inner_force;
        Mat3 F = Mat3::Zero();
        Real whole = 0;
        for (const Index place : places) {
            const auto p = static_cast<std::size_t>(place);
            if (!has_strain(p)) continue;
            F += volume(p) * fields_[p].gradient;
            whole += volume(p);
        }
        return surface_gradient(material, around, force / around.area.norm(), F * around.normal / whole);
    }

    /// Mean over the elements of one material, for each part of the stress.
    Fields mean(std::span<const Index> places, Index material) const {
        Fields sum{Mat3::Zero(), Mat3::Zero()};
        Mat3 volumetric = Mat3::Zero();
        Real whole = 0, whole_volumetric = 0;
        for (const Index place : places) {
            const auto p = static_cast<std::size_t>(place);
            if (!patches_.has_material(near_elements_.covered(body_.cover, p).front(), material)) continue;
            if (has_strain(p)) {
                sum.stress += volume(p) * fields_[p].cauchy_stress;
                sum.strain += volume(p) * green_strain(fields_[p].gradient);
                whole += volume(p);
            } else {
                volumetric += volume(p) * fields_[p].cauchy_stress;
                whole_volumetric += volume(p);
            }
        }
        if (whole > 0) sum = {sum.stress / whole, sum.strain / whole};
        if (whole_volumetric > 0) sum.stress += volumetric / whole_volumetric;
        return sum;
    }

    Fields extrapolated(Index n) const {
        Fields sum{Mat3::Zero(), Mat3::Zero()};
        Real whole = 0;
        for (const Index material : patches_.materials_around(n)) {
            const Real share = patches_.node_volume(n, material);
            const Fields of = extrapolated(n, material);
            sum.stress += share * of.stress;
            sum.strain += share * of.strain;
            whole += share;
        }
        if (whole > 0) sum = {sum.stress / whole, sum.strain / whole};
        return sum;
    }
    Fields extrapolated(Index n, Index material) const {
        const std::vector<Index> donors = patches_.donors(n, material);
        const auto offset = [&](Index donor) -> Vec3 {
            return rest_[static_cast<std::size_t>(donor)] - rest_[static_cast<std::size_t>(n)];
        };
        Real size = 0;
        for (const Index donor : donors) size = std::max(size, offset(donor).norm());
        if (!(size > 0)) size = 1;
        PolynomialFit<linear_terms, 2 * tensor_entries> fit;
        for (const Index donor : donors)
            fit.add(1, offset(donor) / size, pair_of(at_node_[static_cast<std::size_t>(donor)]));
        int rank = 0;
        const Pair value = fit.at_origin(rank);
        return rank == linear_terms ? fields_of(value) : mean(near_elements_.around(patches_.tetrahedra(n)), material);
    }

    const RecoveryInputs& body_;
    std::vector<Vec3> rest_;          // m
    std::span<const Vec3> position_;  // nodes of the body [m]
    NodePatches patches_;
    std::vector<std::uint8_t> wanted_;  // by node: 1 if at_node_ is computed
    std::vector<std::uint8_t> near_;    // by tetrahedron: 1 if the elements that cover it are needed
    ElementsNear near_elements_;
    std::vector<ElementFields> fields_;  // by place of near_elements_
    std::vector<Vec3> centre_;           // by place [m]
    std::vector<Vec3> force_;            // by node [N]
    std::vector<Fields> at_node_;        // by node
};

}  // namespace

NodeFields recover_nodes(const RecoveryInputs& body, std::span<const Index> nodes,
                         decltype(&element_fields) of_blocks) {
    // Rigid bodies have no elements.
    if (body.blocks.size() == 0)
        return {std::vector<Mat3>(nodes.size(), Mat3::Zero()), std::vector<Mat3>(nodes.size(), Mat3::Zero())};
    const Recovery recovery(body, nodes, of_blocks);
    NodeFields fields;
    fields.stress.reserve(nodes.size());
    fields.strain.reserve(nodes.size());
    for (const Index n : nodes) {
        const Fields of_node = recovery.at(n);
        fields.stress.push_back(of_node.stress);
        fields.strain.push_back(of_node.strain);
    }
    return fields;
}

}  // namespace skerry
