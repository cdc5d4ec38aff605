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
    // how much nearer than the contact distance these edges may come, since they are nearly flat [m]
    Real slack = 0;
    Vec3 normal;  // unit, from the second edge to the first
    SegmentSegment closest;
    Real sleep = 0;  // travel after which this may be a contact of gap 0 [m]
};

/// Tests two edges that cross, each on the outer side of the other. Only edges at which their surface is convex take
/// part, and only where the normal lies between the normals of the faces at both edges: elsewhere a point and a face
/// are nearer. Edges inside of a nearly flat face are left out, because their points cover them. The axis of a capsule
/// is an exception: it is touched from all sides, and nearly flat edges count against it. Features further apart than
/// `near` get no close test. Edges of surfaces that may overlap can also have passed each other.
EdgeEdgeContact edge_edge_contact(const SurfaceTables& surface, std::span<const Vec3> position, Index first,
                                  Index second, const PairScale& scale, Real near, Surfaces surfaces);

/// True if a straight or outward bent feature touches an edge of a surface from a direction (unit, normal to the edge):
/// no face at the edge comes nearer. `nearly_flat`: nearly flat edges count, too.
bool edge_faces(const SurfaceTables& surface, std::span<const Vec3> position, Index edge, const Vec3& direction,
                bool nearly_flat);

}  // namespace skerry
