// Contact of an edge of a body with a part of a collider, between the ends of the edge.
#pragma once

#include <array>

#include "components/collider_table.h"
#include "systems/collision/narrow/collider_distance.h"

namespace skerry {

/// True if the signed distance to a part is a convex function, as it is for all parts but the wall of a bucket.
bool is_convex_part(const ColliderGeometry& geometry, Index part);

/// Lower bound of the distance of the edge from a to b (frame of the collider) to a part of the collider [m].
Real edge_distance(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

/// A point of an edge at which it may touch first.
struct EdgePoint {
    Index number;     // identifies the point on the edge from step to step; below crossing_of_edge
    Real s;           // place along the edge, 0 < s < 1 from the first end to the second
    SurfacePoint on;  // nearest point of the collider, in its frame
};

struct EdgeContact {
    Real nearest;                    // lower bound of the distance of the edge [m]
    std::array<EdgePoint, 8> point;  // in ascending order of the numbers
    std::size_t count = 0;
};

/// Finds where along the edge from a to b (frame of the collider) the distance to a part has a minimum between the
/// ends. Where the distance is nearly constant, as along a side of a box, it finds both ends of that stretch. It also
/// finds where the distance begins to rise, so that an edge that lies along a side and reaches beyond it is held there
/// before it turns about the side.
EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

}  // namespace skerry
