// Contact of two edges (docs/methods/collision.md 4.4).
#pragma once

#include <span>

#include "components/surface_table.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

struct EdgeEdgeContact {
    bool touching = false;
    Real distance = 0;  // signed distance between the edges; negative if they have passed each other [m]
    // Nearly flat edges may come nearer to each other than the contact distance by this amount [m].
    Real slack = 0;
    Vec3 normal;  // unit normal in the direction in which contacts push the first edge; valid if `touching`
    SegmentSegment closest;
    Real sleep = 0;  // travel of the pair, counted from now, up to which the edges cannot touch [m]
};

/// Tests two edges for a contact between their interior points. If the distance exceeds both `contact_limit` and
/// scale.edge_depth, only `closest` and `sleep` are computed. An edge can touch only if
/// - the surface is convex at the edge, and not nearly flat: there contacts at the vertices suffice; and
/// - the contact normal lies between the normals of the two faces of the edge; otherwise a point and a face are nearer.
///
/// The axis of a capsule can touch in all directions, and also touches nearly flat edges. If the surfaces may overlap,
/// edges that have passed each other get a contact, too.
EdgeEdgeContact edge_edge_contact(const SurfaceTables& surface, std::span<const Vec3> position, Index first,
                                  Index second, const PairScale& scale, Real contact_limit, Surfaces surfaces);

/// True if a convex feature of another object, such as a straight axis or the side of a cylinder, can touch an edge of
/// a surface: the surface is convex at the edge, and no face at the edge is nearer to the feature. `direction`: unit
/// vector from the edge to the feature, perpendicular to the edge. `nearly_flat`: true if nearly flat edges can also
/// touch the feature.
bool edge_can_touch_along(const SurfaceTables& surface, std::span<const Vec3> position, Index edge,
                          const Vec3& direction, bool nearly_flat);

}  // namespace skerry
