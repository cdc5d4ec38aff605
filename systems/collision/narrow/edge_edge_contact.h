// An edge against an edge (docs/methods/collision.md 4.4).
#pragma once

#include <span>

#include "components/surface_table.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/collision/narrow/point_triangle_contact.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

struct EdgeEdgeContact {
    bool touching = false;
    Real distance = 0;  // m, signed
    Real slack = 0;     // m: how much nearer than the contact distance these edges may come, since they are nearly flat
    Vec3 normal;        // unit, from the second edge to the first
    SegmentSegment closest;
    Real sleep = 0;  // m: travel after which this may be a contact of gap 0
};

/// Two edges that cross, each on the outer side of the other. Only edges at which their surface is convex take part,
/// and only where the normal lies between those of the faces at both edges: elsewhere a point and a face are nearer.
/// Edges inside of a nearly flat face are left out, their points cover them, but for the axis of a capsule, which is
/// touched from all sides. Features further than `near` are not looked at closely. Edges of surfaces that may overlap
/// can also have passed each other.
EdgeEdgeContact edge_edge_contact(const SurfaceTables& surface, std::span<const Vec3> position, Index first,
                                  Index second, const PairScale& scale, Real near, Surfaces surfaces);

/// Whether what is nearly straight, or bends outward, touches an edge of a surface from a direction (unit, normal to
/// the edge): no face at the edge comes nearer. `nearly_flat`: those count, too.
bool edge_faces(const SurfaceTables& surface, std::span<const Vec3> position, Index edge, const Vec3& direction,
                bool nearly_flat);

}  // namespace skerry
