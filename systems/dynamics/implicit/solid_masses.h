// Inertia and angular momentum of the solid that a body's tetrahedra fill, in any shape. Velocities are interpolated
// linearly within each tetrahedron (docs/methods/implicit_bodies.md 8).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Deformed shape of a body. Entries are in the elimination order of the nodes.
struct BodyShape {
    std::vector<Vec3> position;  // node positions relative to the centre of mass [m]
    // Lever arm of each node, weighted by mass [kg m]. The angular momentum of the solid is the sum of arm x v over the
    // nodes with the velocities v. The arm is the integral of rho N x over the body: density rho, shape function N of
    // the node, position x relative to the centre of mass.
    std::vector<Vec3> arm;

    /// Inertia tensor of the shape about the centre of mass [kg m^2].
    Mat3 inertia() const;
    Vec3 angular_momentum(std::span<const Vec3> velocity) const;
};

class SolidMasses {
public:
    SolidMasses() = default;
    /// `mass`: by tetrahedron [kg]; `order_index`: index of each node in the elimination order.
    SolidMasses(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> mass,
                std::span<const Index> order_index);

    /// Computes the lever arms of a shape from its node positions.
    void find_arms(BodyShape& shape) const;

private:
    // For each tetrahedron: indices of the corners in the elimination order.
    std::vector<std::array<Index, 4>> corners_;
    std::vector<Real> share_;  // a twentieth of the mass of each tetrahedron [kg]
};

}  // namespace skerry
