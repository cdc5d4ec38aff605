// Finds the material point of a body at a given position.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>

#include "components/types.h"
#include "systems/geometry/material_point.h"

namespace skerry {

/// Returns a material point at the position `point`, as nodes and barycentric coordinates:
/// - in a body with tetrahedra: the corners of the tetrahedron that contains the position. Otherwise the nearest node,
///   or nothing if this node is farther away than `reach` [m].
/// - in a body without tetrahedra, which is rigid: four nodes of the body, for any position.
std::optional<MaterialPoint> follow_point(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& point, Real reach);

/// Returns the node nearest to `point`, and its distance from `point` [m].
std::pair<Index, Real> nearest_node(std::span<const Vec3> nodes, const Vec3& point);

}  // namespace skerry
