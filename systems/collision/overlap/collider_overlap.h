// Overlap of a body and an analytic collider.
#pragma once

#include <array>
#include <optional>

#include "components/collider_table.h"
#include "systems/collision/overlap/solid_overlap.h"

namespace skerry {

/// Overlap of a collider with the nodes and edges of a body's surface. Nodes and points of edges count if they are
/// inside the collider by more than `tolerance` [m]. Overlap::depth and direction belong to the deepest point. The kind
/// is `inside` if all nodes are in the collider, otherwise `crossing`.
std::optional<Overlap> find_surface_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                           const PlacedSolid& body, Real tolerance);

/// Overlap of a body with a collider that contains no node and no point of an edge of the body. Call it only if
/// find_surface_inside has found no overlap. The kind is
/// - `around` if the body contains the complete collider;
/// - `crossing` if a corner, an end or a rim of the collider has entered the body through the interior of a face, by
///   more than `tolerance` [m].
std::optional<Overlap> find_collider_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                            const PlacedSolid& body, Real tolerance);

/// A round body: all points within `radius` of a core, which is a point or a segment.
struct RoundSolid {
    std::array<Vec3, 2> end;  // ends of the core; a core that is a point has two equal ends [m]
    bool is_segment;
    Real radius;  // [m]
};

/// Overlap of a round body with a collider by more than `tolerance` [m]. The kind is `inside` if both ends of the core
/// are in the collider, otherwise `crossing`.
std::optional<Overlap> overlap_of_round(const RoundSolid& body, const ColliderGeometry& geometry,
                                        const RigidMotion& motion, Real tolerance);

}  // namespace skerry
