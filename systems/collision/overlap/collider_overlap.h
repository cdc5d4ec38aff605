// Whether a body and an analytic collider share room.
#pragma once

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

/// A body that is a sphere.
struct SphereSolid {
    Vec3 middle;  // m
    Real radius;  // m
};

/// Of a sphere and a collider, by more than `tolerance` (m): inside where the middle is.
std::optional<Overlap> overlap_of_sphere(const SphereSolid& sphere, const ColliderGeometry& geometry,
                                         const RigidMotion& motion, Real tolerance);

}  // namespace skerry
