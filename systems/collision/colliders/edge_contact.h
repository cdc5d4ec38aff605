// Contact of an edge of a body with a part of a collider, between the ends of the edge.
#pragma once

#include <array>

#include "components/collider_table.h"
#include "systems/collision/narrow/collider_distance.h"

namespace skerry {

/// True if the signed distance to a part is a convex function. This holds for all parts except the wall of a bucket.
bool is_convex_part(const ColliderGeometry& geometry, Index part);

/// Lower bound of the distance between an edge and a part of a collider [m]. `a`, `b`: ends of the edge in the frame of
/// the collider.
Real edge_distance(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

/// A point of an edge at which the edge may touch the collider first.
struct EdgePoint {
    Index number;     // identifies the point on the edge from step to step; below crossing_of_edge
    Real s;           // position along the edge, with 0 < s < 1 from the first end to the second
    SurfacePoint on;  // nearest point of the collider, in the frame of the collider
};

struct EdgeContact {
    Real nearest;                    // lower bound of the distance between edge and part [m]
    std::array<EdgePoint, 8> point;  // in ascending order of EdgePoint::number
    std::size_t count = 0;
};

/// Finds the points at which the distance between an edge and a part of a collider has a minimum between the ends. `a`,
/// `b`: ends of the edge in the frame of the collider. Where the distance is nearly constant, for example along a side
/// of a box, it finds both ends of this stretch. It also finds the position where the distance begins to rise. So an
/// edge that lies on a side and extends beyond it is held at the end of the side before it rotates about this end.
EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

}  // namespace skerry
