// Finds the material point at a place.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "components/types.h"

namespace skerry {

struct MaterialPoint {
    std::array<Index, 4> node{};
    std::array<Real, 4> weight{};
};

/// Returns the corners of the tetrahedron that contains the place, with its barycentric coordinates. Outside all
/// tetrahedra it returns the nearest node, if that is no further away than `reach` [m], or else nothing.
std::optional<MaterialPoint> follow_point(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& place, Real reach);

/// Returns the nearest node and its distance [m].
std::pair<Index, Real> nearest_node(std::span<const Vec3> nodes, const Vec3& place);

}  // namespace skerry
