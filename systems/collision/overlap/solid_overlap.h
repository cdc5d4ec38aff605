// Overlap of two solids, and the direction and distance that separate them (docs/methods/collision.md 9).
#pragma once

#include <optional>

#include "components/options.h"
#include "systems/collision/overlap/solid.h"

namespace skerry {

struct Overlap {
    OverlapKind kind;
    Real depth;      // distance along `direction` by which the first solid has to move to be apart [m]
    Vec3 direction;  // unit
    Vec3 place;      // middle of the overlap region [m]
};

/// A solid, and its translation since the solid was made.
struct PlacedSolid {
    const Solid& solid;
    Vec3 shift;  // [m]

    Aabb box() const { return {solid.box.lower + shift, solid.box.upper + shift}; }
};

/// Overlap of two solids, of which the first consists of tetrahedra. They overlap if a tetrahedron of the first and a
/// simplex of the second overlap by more than `tolerance` [m], or if the first is inside a closed surface that is the
/// second. If their surfaces cross, `direction` is close to the direction of the shortest way out. If one contains the
/// other, it is the best of a few directions, and `depth` moves the first beyond the end of the second.
std::optional<Overlap> find_overlap(const PlacedSolid& first, const PlacedSolid& second, Real tolerance);

}  // namespace skerry
