// Contact between a part of a collider and an edge of a body, at points between the ends of the edge.
#pragma once

#include <array>

#include "components/collider_table.h"
#include "systems/collision/narrow/collider_distance.h"

namespace skerry {

/// True if the signed distance from a part of a collider is a convex function. All parts except the wall of a bucket
/// are convex.
bool is_convex_part(const ColliderGeometry& geometry, Index part);

/// Lower bound of the distance between an edge and a part of a collider [m]. `a`, `b`: ends of the edge in the frame of
/// the collider.
Real edge_distance(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

/// A point between the ends of an edge at which a contact may be needed.
struct EdgePoint {
    Index number;     // number that identifies the point on the edge across steps; below crossing_of_edge
    Real s;           // position along the edge: 0 at the first end, 1 at the second end; 0 < s < 1
    SurfacePoint on;  // nearest point of the collider, in the frame of the collider
};

struct EdgeContact {
    Real nearest;                    // lower bound of the distance between the edge and the part [m]
    std::array<EdgePoint, 8> point;  // contact points in ascending order of EdgePoint::number
    std::size_t count = 0;
};

/// Finds the points between the ends of an edge at which the distance between the edge and a part of a collider has a
/// minimum. `a`, `b`: ends of the edge in the frame of the collider. Other points are found, too:
/// - If the distance is nearly constant on a stretch of the edge, for example along a side of a box, both ends of this
///   stretch are found instead of the minimum.
/// - Points beyond which the distance rises steeply (steep_slope). Example: an edge lies, slightly tilted, on a side of
///   a box and extends beyond its border. The minimum is not at the border, but a contact there supports the edge
///   before it rotates about the border.
EdgeContact edge_contact(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b);

}  // namespace skerry
