// Overlap of two solids, and the way to take them apart (docs/methods/collision.md 9).
#pragma once

#include <optional>

#include "components/options.h"
#include "systems/collision/overlap/solid.h"

namespace skerry {

struct Overlap {
    OverlapKind kind;
    Real depth;      // the first is apart from the second when moved this far along `direction` [m]
    Vec3 direction;  // unit
    Vec3 place;      // middle of the shared region [m]
};

/// A solid, and how far it has been moved since it was made.
struct PlacedSolid {
    const Solid& solid;
    Vec3 shift;  // [m]

    Aabb box() const { return {solid.box.lower + shift, solid.box.upper + shift}; }
};

/// Overlap of two solids, the first of which has volume. They overlap if a tetrahedron of the first and a simplex of
/// the second overlap by more than `tolerance` [m], or if the first lies in the closed surface that is the second. For
/// surfaces that go through each other, `direction` is about the one of the shortest way out. For solids inside each
/// other, it is the best of a few, and `depth` takes the extent of the first past that of the second.
std::optional<Overlap> find_overlap(const PlacedSolid& first, const PlacedSolid& second, Real tolerance);

}  // namespace skerry
