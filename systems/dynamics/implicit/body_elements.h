// Energy, forces and tangent of the elements of an implicit body, by the laws of their materials at any strain
// (docs/methods/implicit_bodies.md 8).
#pragma once

#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/types.h"
#include "systems/dynamics/implicit/block_cholesky.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Displacements of the nodes of a body from their rest positions, read by place in the elimination order [m]. The
/// values are stored by place, or by node with `node_at`, the node of each place.
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
    /// `constants`: by row of MaterialTable; `place`: place of each node in the elimination order.
    BodyElements(const ElementList& elements, std::span<const MaterialConstants> constants,
                 std::span<const Index> place);

    /// True if the law of some element is not linear.
    bool any_bends() const { return any_bends_; }
    /// Largest |F - 1| of all elements (Frobenius norm).
    Real largest_strain(const Displacements& displacement) const;
    /// Bound on the change of largest_strain() per largest change of a displacement [1/m].
    Real strain_by_displacement() const { return strain_by_displacement_; }
    /// Elastic energy of all elements [J].
    Real energy(const Displacements& displacement) const;
    struct Misfit {
        Real linear,
            off;  // energy by linear laws; sum over the elements of its distance from the energy by their laws [J]
    };
    Misfit misfit(const Displacements& displacement) const;
    /// out = dU/dx, by place [N].
    void forces(const Displacements& displacement, std::span<Vec3> out) const;
    /// matrix += scale d2U/dx2, without the negative part of d2U/dx2 [N/m]. The first call locates the blocks in the
    /// matrix. Matrices of later calls must have the same pattern.
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

    std::vector<std::size_t> first_{0};  // start of each element in place_ and gradient_; elements + 1 entries
    std::vector<Index> place_;
    std::vector<Vec3> gradient_;               // of each node of each element [1/m]
    std::vector<Real> volume_;                 // [m^3]
    std::vector<MaterialConstants> material_;  // constants of the part of the stress that the element gives
    bool any_bends_ = false;
    Real strain_by_displacement_ = 0;
    std::vector<Index> block_;  // block in the matrix of node pairs k >= l, element by element
    std::vector<Vec3> turned_;  // work memory for one element
};

}  // namespace skerry
