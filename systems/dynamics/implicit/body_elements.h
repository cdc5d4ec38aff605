// Energy, forces and tangent stiffness of the elements of an implicit body at any strain, by the laws of their
// materials (docs/methods/implicit_bodies.md 8).
#pragma once

#include <span>
#include <vector>

#include "components/material_table.h"
#include "components/types.h"
#include "systems/dynamics/implicit/block_cholesky.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

/// Displacements of the nodes of a body from their rest positions [m], read by the index of the node in the elimination
/// order. They are stored in this order or by node. If they are stored by node, `node_at` gives the node at each index
/// of the elimination order.
class Displacements {
public:
    Displacements(std::span<const Vec3> by_order) : by_order_(by_order) {}
    Displacements(const std::vector<Vec3>& by_order) : by_order_(by_order) {}
    Displacements(std::span<const Vec3> by_node, std::span<const Index> node_at)
        : by_order_(by_node), node_at_(node_at) {}
    const Vec3& operator[](Index order_index) const {
        const auto k = static_cast<std::size_t>(order_index);
        return by_order_[node_at_.empty() ? k : static_cast<std::size_t>(node_at_[k])];
    }

private:
    std::span<const Vec3> by_order_;
    std::span<const Index> node_at_{};
};

class BodyElements {
public:
    BodyElements() = default;
    /// `constants`: material constants by row of MaterialTable; `order_index`: index of each node in the elimination
    /// order.
    BodyElements(const ElementList& elements, std::span<const MaterialConstants> constants,
                 std::span<const Index> order_index);

    /// True if some element has a nonlinear material law.
    bool any_nonlinear() const { return any_nonlinear_; }
    /// Largest Frobenius norm |F - 1| of all elements, with the deformation gradient F.
    Real largest_strain(const Displacements& displacement) const;
    /// Upper bound on the change of largest_strain(), divided by the largest change of a node's displacement (a
    /// Lipschitz constant) [1/m].
    Real strain_by_displacement() const { return strain_by_displacement_; }
    /// Elastic energy of all elements at the given displacements [J].
    Real energy(const Displacements& displacement) const;
    struct EnergyDifference {
        // `linear`: energy of all elements by linear elasticity [J]. `difference`: absolute difference between the
        // energies of an element by the material law and by linear elasticity, summed over the elements [J].
        Real linear, difference;
    };
    EnergyDifference compare_energies(const Displacements& displacement) const;
    /// Computes out = dU/dx, the gradient of the elastic energy U, by index of the node in the elimination order [N].
    void forces(const Displacements& displacement, std::span<Vec3> out) const;
    /// Adds `scale` times the second derivative d2U/dx2 of the elastic energy U to `matrix` [N/m]. Negative eigenvalues
    /// of the second derivatives of single elements are replaced by zero, so that the sum is positive semidefinite. The
    /// first call finds which blocks of the matrix each element adds to, so later matrices must have the same pattern.
    void add_tangent(const Displacements& displacement, Real scale, BlockRows& matrix);

private:
    struct Nodes {
        std::span<const Index> order_index;
        std::span<const Vec3> gradient;
    };
    std::size_t size() const { return volume_.size(); }
    Nodes nodes_of(std::size_t e) const;
    Mat3 gradient_of(std::size_t e, const Displacements& displacement) const;
    void find_blocks(const BlockRows& matrix);

    std::vector<std::size_t> first_{0};  // start of each element in order_index_ and gradient_; elements + 1 entries
    std::vector<Index> order_index_;
    std::vector<Vec3> gradient_;  // shape gradient at each node of each element [1/m]
    std::vector<Real> volume_;    // [m^3]
    // Material constants of each element. An element may exert only a part of the stress, for example the volumetric
    // part (ElementPart). The constants of all other parts are then zero.
    std::vector<MaterialConstants> material_;
    bool any_nonlinear_ = false;
    Real strain_by_displacement_ = 0;
    // For each element and each pair of its nodes (also equal ones): index of the matrix block that couples the nodes.
    std::vector<Index> block_;
    std::vector<Vec3> turned_;  // work memory: shape gradients of one element in principal axes
};

}  // namespace skerry
