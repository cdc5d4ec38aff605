// An edge of a body against a part of a collider, between its ends.
#pragma once

#include <array>

#include "components/collider_table.h"
#include "systems/collision/narrow/collider_distance.h"

namespace skerry {

/// Whether the signed distance to a part is a convex function: of all but the wall of a bucket.
bool is_convex_part(const ColliderGeometry& geometry, Index part);

/// No point of the edge from a to b (frame of the collider) is nearer to a part of the collider than this, m.
Real edge_distance(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

/// A point of an edge that may touch first.
struct EdgePoint {
    Index number;     // below crossing_of_edge: which of the edge's points it is, from step to step
    Real s;           // its place, 0 < s < 1 from the first end to the second
    SurfacePoint on;  // of the collider, in its frame
};

struct EdgeContact {
    Real nearest;                    // m: no point of the edge is nearer, by what was found
    std::array<EdgePoint, 8> point;  // by number
    std::size_t count = 0;
};

/// Where along the edge from a to b (frame of the collider) the distance to a part has a minimum that is not at one of
/// its ends; where it is nearly flat, as along a side of a box, both ends of that stretch. Also where it begins to
/// rise: an edge that lies along a side and reaches beyond it has its other end held there, before it turns about it.
EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

}  // namespace skerry
