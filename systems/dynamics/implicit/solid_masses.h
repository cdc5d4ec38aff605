// How the solid that tetrahedra fill turns, whatever its shape: inertia and angular momentum of velocities that go
// linearly from node to node (docs/methods/implicit_bodies.md 8).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/types.h"

namespace skerry {

/// A shape that the nodes of a body have, by place.
struct BodyShape {
    std::vector<Vec3> position;  // m, from the centre of mass
    std::vector<Vec3> arm;       // kg m: the angular momentum of velocities v of nodes is sum arm x v

    /// kg m^2, about the centre.
    Mat3 inertia() const;
    Vec3 angular_momentum(std::span<const Vec3> velocity) const;
};

class SolidMasses {
public:
    SolidMasses() = default;
    /// `mass`: kg, by tetrahedron; `place`: of each node.
    SolidMasses(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> mass,
                std::span<const Index> place);

    /// From the positions of the shape.
    void find_arms(BodyShape& shape) const;

private:
    std::vector<std::array<Index, 4>> corners_;  // places
    std::vector<Real> share_;                    // kg, a twentieth of the mass
};

}  // namespace skerry
