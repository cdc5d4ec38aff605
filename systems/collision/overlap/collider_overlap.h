// Whether a body and an analytic collider share room.
#pragma once

#include <array>
#include <optional>

#include "components/collider_table.h"
#include "systems/collision/overlap/solid_overlap.h"

namespace skerry {

/// Of nodes and edges of a body's surface that lie in a collider by more than `tolerance` (m): `depth` and `direction`
/// are those of the deepest point. crossing, or inside where all nodes lie in it.
std::optional<Overlap> find_surface_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                           const PlacedSolid& body, Real tolerance);

/// A collider that no node or edge lies in may be inside the body: as a whole, around, or by a corner, an end or a rim
/// that has come in between the edges of a face, by more than `tolerance` (m), crossing.
std::optional<Overlap> find_collider_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                            const PlacedSolid& body, Real tolerance);

/// A body that is round about its core: a point, or a segment.
struct RoundSolid {
    std::array<Vec3, 2> end;  // m, of a point twice the same
    bool is_segment;
    Real radius;  // m
};

/// Of a round body and a collider, by more than `tolerance` (m): inside where all of its core is, or the point.
std::optional<Overlap> overlap_of_round(const RoundSolid& body, const ColliderGeometry& geometry,
                                        const RigidMotion& motion, Real tolerance);

}  // namespace skerry
