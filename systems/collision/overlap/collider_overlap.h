// Whether a body and an analytic collider share room.
#pragma once

#include <optional>

#include "components/collider_table.h"
#include "systems/collision/overlap/solid_overlap.h"

namespace skerry {

/// Of points of a body's surface that lie in a collider by more than `tolerance` (m): `depth` and `direction` are those
/// of the deepest. Points that a contact sees alone: what a collider has between two of them is not looked at.
/// crossing, or inside where all lie in it.
std::optional<Overlap> find_points_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                          const PlacedSolid& body, Real tolerance);

/// A collider that no point of the surface lies in may be inside the body as a whole.
std::optional<Overlap> find_collider_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                            const PlacedSolid& body);

}  // namespace skerry
