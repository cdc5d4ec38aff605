// An edge of a body against a part of a collider, between its ends.
#pragma once

#include <array>

#include "components/collider_table.h"
#include "systems/collision/narrow/collider_distance.h"

namespace skerry {

/// No point of the edge from a to b (frame of the collider) is nearer to a part of the collider than this, m.
Real edge_distance(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

/// A point of an edge that touches first.
struct EdgePoint {
    Real s;           // its place, 0 < s < 1 from the first end to the second
    SurfacePoint on;  // of the collider, in its frame
};

struct EdgeContact {
    Real nearest;                    // m, edge_distance
    std::array<EdgePoint, 4> point;  // by s
    std::size_t count = 0;
};

/// Where along the edge from a to b (frame of the collider) the distance to a part has a minimum that is not at one of
/// its ends. Where it is nearly flat, as along a side of a box, both ends of that stretch.
EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

}  // namespace skerry
