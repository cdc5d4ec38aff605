// Overlap of two solids, and the direction and distance of a motion that separates them (docs/methods/collision.md 9).
#pragma once

#include <optional>

#include "components/options.h"
#include "systems/collision/overlap/solid.h"

namespace skerry {

struct Overlap {
    OverlapKind kind;
    // Distance by which the first solid has to move along `direction` to be separated from the second [m].
    Real depth;
    Vec3 direction;  // unit vector
    Vec3 place;      // centre of the region of overlap [m]
};

/// A solid, and the translation of the solid since it was made.
struct PlacedSolid {
    const Solid& solid;
    Vec3 shift;  // [m]

    Aabb box() const { return {solid.box.lower + shift, solid.box.upper + shift}; }
};

/// Overlap of two solids. They overlap if two of their simplices overlap by more than `tolerance` [m], or if one solid
/// is inside the closed surface of the other. The result contains a separating motion:
/// - If the surfaces cross, `direction` is close to the direction of the shortest separating motion.
/// - If one solid contains the other, the motion is the shortest of a few motions that take all points of the first
///   solid past all points of the second.
std::optional<Overlap> find_overlap(const PlacedSolid& first, const PlacedSolid& second, Real tolerance);

/// Finds a surface point of `solid` that touches the open `surface` from behind, so closely that contacts cannot tell
/// on which side of the surface the solid is. The point is at most `tolerance` [m] from a triangle of `surface`, and
/// the outward normal of the solid at the point forms an acute angle with the normal of the triangle. The returned
/// overlap moves the solid further back by twice the tolerance.
std::optional<Overlap> find_touch_of_open_surface(const PlacedSolid& solid, const PlacedSolid& surface, Real tolerance);

}  // namespace skerry
