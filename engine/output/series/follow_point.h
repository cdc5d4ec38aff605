// Which material point lies at a place.
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

/// The corners of the tetrahedron that the place lies in, with its barycentric coordinates; the nearest node where it
/// lies in none, but no further from that than `reach` (m); else nothing.
std::optional<MaterialPoint> follow_point(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& place, Real reach);

/// Which node that is, and how far, m.
std::pair<Index, Real> nearest_node(std::span<const Vec3> nodes, const Vec3& place);

}  // namespace skerry
