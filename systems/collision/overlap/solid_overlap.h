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

/// Overlap of two solids. The solids overlap if a simplex of the first and a simplex of the second overlap by more than
/// `tolerance` [m], or if one solid is inside the closed surface of the other. If the two surfaces cross, `direction`
/// is close to the direction of the shortest separating motion. If one solid contains the other, `direction` is the
/// best of a few directions, and a motion by `depth` takes the first solid past the end of the second.
std::optional<Overlap> find_overlap(const PlacedSolid& first, const PlacedSolid& second, Real tolerance);

/// Finds a point of a solid that touches the back of an open surface: its distance is at most `tolerance` [m]. At such
/// a distance contacts cannot detect the side of the surface on which the solid is.
std::optional<Overlap> find_touch_of_open_surface(const PlacedSolid& solid, const PlacedSolid& surface, Real tolerance);

}  // namespace skerry
