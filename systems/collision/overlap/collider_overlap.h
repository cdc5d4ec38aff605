// Overlap of a body and an analytic collider.
#pragma once

#include <array>
#include <optional>

#include "components/collider_table.h"
#include "systems/collision/overlap/solid_overlap.h"

namespace skerry {

/// Overlap of a collider with the nodes and edges of a body's surface that lie in it by more than `tolerance` [m].
/// `depth` and `direction` are those of the deepest point. The kind is inside if all nodes lie in the collider, else
/// crossing.
std::optional<Overlap> find_surface_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                           const PlacedSolid& body, Real tolerance);

/// Overlap with a collider that contains no node or edge of the body. Either the whole collider is inside the body
/// (around), or a corner, an end or a rim of it has entered between the edges of a face by more than `tolerance` [m]
/// (crossing).
std::optional<Overlap> find_collider_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                            const PlacedSolid& body, Real tolerance);

/// A round body: all points within `radius` of its core, a point or a segment.
struct RoundSolid {
    std::array<Vec3, 2> end;  // for a point twice the same [m]
    bool is_segment;
    Real radius;  // [m]
};

/// Overlap of a round body with a collider by more than `tolerance` [m]. The kind is inside if both ends of the core
/// lie in the collider, else crossing.
std::optional<Overlap> overlap_of_round(const RoundSolid& body, const ColliderGeometry& geometry,
                                        const RigidMotion& motion, Real tolerance);

}  // namespace skerry
