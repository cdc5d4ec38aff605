// Rotation of the solid that tetrahedra fill, in any shape: inertia and angular momentum of velocities that are linear
// in each tetrahedron (docs/methods/implicit_bodies.md 8).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Shape of a body, by place of its nodes.
struct BodyShape {
    std::vector<Vec3> position;  // from the centre of mass [m]
    std::vector<Vec3> arm;       // the angular momentum of node velocities v is sum arm x v [kg m]

    /// Inertia about the centre of mass [kg m^2].
    Mat3 inertia() const;
    Vec3 angular_momentum(std::span<const Vec3> velocity) const;
};

class SolidMasses {
public:
    SolidMasses() = default;
    /// `mass`: by tetrahedron [kg]; `place`: place of each node.
    SolidMasses(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> mass,
                std::span<const Index> place);

    /// Computes the arms from the positions of the shape.
    void find_arms(BodyShape& shape) const;

private:
    std::vector<std::array<Index, 4>> corners_;  // places of the corners
    std::vector<Real> share_;                    // a twentieth of the mass of each tetrahedron [kg]
};

}  // namespace skerry
