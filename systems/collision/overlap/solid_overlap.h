// Whether two solids share room, and how to take them apart (docs/methods/collision.md 9).
#pragma once

#include <optional>

#include "components/options.h"
#include "systems/collision/overlap/solid.h"

namespace skerry {

struct Overlap {
    OverlapKind kind;
    Real depth;      // m: moved so far along `direction`, the first is apart from the second
    Vec3 direction;  // unit
    Vec3 place;      // m, the middle of what both fill
};

/// A solid and by how much it has been moved since it was made.
struct PlacedSolid {
    const Solid& solid;
    Vec3 shift;  // m

    Aabb box() const { return {solid.box.lower + shift, solid.box.upper + shift}; }
};

/// Of two solids, the first of which has volume, where a tetrahedron of it and a simplex of the second overlap by more
/// than `tolerance` (m), or it lies in the closed surface that the second is. Of surfaces that go through each other
/// `depth` is that of the direction in which it is about least; of solids inside each other it is that of their boxes,
/// which is enough. Also `direction` is then one of a few.
std::optional<Overlap> find_overlap(const PlacedSolid& first, const PlacedSolid& second, Real tolerance);

}  // namespace skerry
