// Material points: points that move with a tetrahedron.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/types.h"

namespace skerry {

/// A point given by the corners of a tetrahedron and its barycentric coordinates, whose sum is 1.
struct MaterialPoint {
    std::array<Index, 4> node{};
    std::array<Real, 4> weight{};
};

/// Returns the material point of a tetrahedron that is at `position` [m], inside or outside the tetrahedron. `nodes`:
/// node positions [m].
MaterialPoint point_of_tetrahedron(std::span<const Vec3> nodes, const std::array<Index, 4>& corners,
                                   const Vec3& position);

/// Returns the material point of a rigid body that is at `position` [m], inside or outside the body. The corners of its
/// tetrahedron are four nodes of the body far from each other, so that rounding errors of the weights stay small. The
/// nodes of the body must not all lie in one plane.
MaterialPoint point_of_solid(std::span<const Vec3> nodes, const Vec3& position);

/// Returns the point of the first tetrahedron that contains `position`, or nothing if no tetrahedron contains it.
std::optional<MaterialPoint> point_inside(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& position);

}  // namespace skerry
