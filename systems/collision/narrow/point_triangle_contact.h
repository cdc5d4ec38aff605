// Contact of a point with a triangle of a closed surface (docs/methods/collision.md 4.1 to 4.3).
#pragma once

#include <span>

#include "components/surface_table.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

enum class Side : std::uint8_t {
    none,     // no contact with this triangle: a neighbour owns it, or the point is out of reach
    outside,  // a contact
    behind,   // a contact if no other triangle of the body is nearer to the point
};

/// Knowledge about two surfaces. If they are apart, a point behind a triangle has not come through it: the body is thin
/// or folded there, or an element is inverted, and the point stays behind. If they may overlap, the point is pushed out
/// to the front.
enum class Surfaces : std::uint8_t { apart, may_overlap };

struct PointTriangleContact {
    Side side = Side::none;
    Real distance = 0;  // signed [m]
    Vec3 normal;        // unit, out of the triangle's body, or away from its back
    PointTriangle closest;
    // travel after which this may be a contact of gap 0; if not positive, it is tested again in the next step [m]
    Real sleep = 0;
};

/// Tests the point against the nearest feature of the triangle. A point that is nearest to an edge or a vertex is left
/// to the lowest triangle around it, and is a contact only if no other triangle around comes nearer. The normal is that
/// of the face, or points from the edge or vertex to the point, or, if the point is too near for that, is the mean of
/// the faces around. The core of a round body is touched from all sides. Features further apart than `near` get no
/// close test.
PointTriangleContact point_triangle_contact(const SurfaceTables& surface, std::span<const Vec3> position,
                                            const Vec3& point, Index triangle, const PairScale& scale, Real near,
                                            Surfaces surfaces);

/// True if a vertex touches the axis of a capsule whose nearest place is at `offset` from it: no face around the vertex
/// comes nearer to that place, apart from a small tilt of the axis.
bool vertex_holds_axis(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex, const Vec3& offset,
                       const Vec3& axis, const PairScale& scale);

/// True if a vertex touches a place at `offset` from it: no face around the vertex comes nearer to that place.
bool vertex_holds_place(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex, const Vec3& offset,
                        const PairScale& scale);

}  // namespace skerry
