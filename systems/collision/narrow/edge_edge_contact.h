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
    Real distance = 0;  // signed [m]
    // Distance by which these edges may come nearer than the contact distance, because they are nearly flat [m].
    Real slack = 0;
    Vec3 normal;  // unit normal from the second edge to the first
    SegmentSegment closest;
    Real sleep = 0;  // travel after which the edges may be a contact of gap 0 [m]
};

/// Tests two edges that cross, each on the outer side of the other. An edge takes part only if its surface is convex
/// there, and only if the contact normal lies between the normals of its two faces. Otherwise a point and a face are
/// nearer. Edges within a nearly flat surface are left out, because tests of the surface's points suffice. The axis of
/// a capsule is an exception: it can be touched from all sides, also by nearly flat edges. Edges further apart than
/// `near` get no closer test. If the surfaces may overlap, the edges can also have passed each other.
EdgeEdgeContact edge_edge_contact(const SurfaceTables& surface, std::span<const Vec3> position, Index first,
                                  Index second, const PairScale& scale, Real near, Surfaces surfaces);

/// True if a straight or outward bent feature can touch an edge of a surface, because no face at the edge comes nearer
/// to the feature. `direction`: unit vector from the edge to the feature, normal to the edge. `nearly_flat`: true if
/// nearly flat edges count, too.
bool edge_faces(const SurfaceTables& surface, std::span<const Vec3> position, Index edge, const Vec3& direction,
                bool nearly_flat);

}  // namespace skerry
