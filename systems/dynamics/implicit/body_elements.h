// The elements of a body that moves implicitly by the laws of their materials, whatever the strain
// (docs/methods/implicit_bodies.md 8).
#pragma once

#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/types.h"
#include "systems/dynamics/implicit/block_cholesky.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// m, of the nodes of a body from their rest positions, in the order of elimination.
class Displacements {
public:
    Displacements(std::span<const Vec3> by_place) : by_place_(by_place) {}
    Displacements(const std::vector<Vec3>& by_place) : by_place_(by_place) {}
    Displacements(std::span<const Vec3> by_node, std::span<const Index> node_at)
        : by_place_(by_node), node_at_(node_at) {}
    const Vec3& operator[](Index place) const {
        const auto k = static_cast<std::size_t>(place);
        return by_place_[node_at_.empty() ? k : static_cast<std::size_t>(node_at_[k])];
    }

private:
    std::span<const Vec3> by_place_;
    std::span<const Index> node_at_{};
};

class BodyElements {
public:
    BodyElements() = default;
    /// `constants`: by row of MaterialTable; `place`: of each node in the order of elimination.
    BodyElements(const ElementList& elements, std::span<const MaterialConstants> constants,
                 std::span<const Index> place);

    /// Whether some law is not linear.
    bool any_bends() const { return any_bends_; }
    /// Largest |F - 1| (Frobenius norm).
    Real largest_strain(const Displacements& displacement) const;
    /// 1/m, the most that changes by where displacements change by this much.
    Real strain_by_displacement() const { return strain_by_displacement_; }
    /// J
    Real energy(const Displacements& displacement) const;
    struct Misfit {
        Real linear, off;  // J: energy by linear laws; what laws differ from that, of each element whether more or less
    };
    Misfit misfit(const Displacements& displacement) const;
    /// out = dU/dx, N, by place.
    void forces(const Displacements& displacement, std::span<Vec3> out) const;
    /// matrix += scale d2U/dx2 without what is negative of it, N/m. The first call finds where the blocks are in the
    /// matrix, which then has to have the same pattern.
    void add_tangent(const Displacements& displacement, Real scale, BlockRows& matrix);

private:
    struct Nodes {
        std::span<const Index> place;
        std::span<const Vec3> gradient;
    };
    std::size_t size() const { return volume_.size(); }
    Nodes nodes_of(std::size_t e) const;
    Mat3 gradient_of(std::size_t e, const Displacements& displacement) const;
    void find_blocks(const BlockRows& matrix);

    std::vector<std::size_t> first_{0};  // of each element in place_ and gradient_; one more than elements
    std::vector<Index> place_;
    std::vector<Vec3> gradient_;               // 1/m
    std::vector<Real> volume_;                 // m^3
    std::vector<MaterialConstants> material_;  // of the part of the stress that the element gives
    bool any_bends_ = false;
    Real strain_by_displacement_ = 0;
    std::vector<Index> block_;  // of pairs of nodes k >= l, element after element
    std::vector<Vec3> turned_;  // memory, of one element
};

}  // namespace skerry
