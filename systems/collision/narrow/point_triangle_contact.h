// Contact of a point with a triangle of a closed surface (docs/methods/collision.md 4.1 to 4.3).
#pragma once

#include <span>

#include "components/surface_table.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

enum class Side : std::uint8_t {
    none,     // no contact with this triangle, because the point belongs to a neighbour or is out of reach
    outside,  // a contact
    behind,   // a contact, provided that no other triangle of the body is nearer to the point
};

/// State of two surfaces. If the surfaces are apart, a point behind a triangle has not passed through this triangle.
/// The body is thin or folded there, or an element is inverted, and the point has to stay behind the triangle. If the
/// surfaces may overlap, the point is pushed out to the front.
enum class Surfaces : std::uint8_t { apart, may_overlap };

struct PointTriangleContact {
    Side side = Side::none;
    Real distance = 0;  // signed [m]
    Vec3 normal;        // unit normal away from the front of the triangle, or away from its back
    PointTriangle closest;
    // Travel after which this may be a contact of gap 0; if not positive, the candidate is tested again in the next
    // step [m].
    Real sleep = 0;
};

/// Tests a point against the nearest feature of a triangle: its face, an edge or a vertex. If an edge or vertex is
/// nearest, only the triangle around it with the lowest row reports the contact, and only if no other triangle around
/// it is nearer to the point. The normal is that of the face, or points from the edge or vertex to the point. If the
/// point is too near for this, the normal is the mean of the normals of the faces around. The core of a round body can
/// be touched from all sides. Features further apart than `near` get no closer test.
PointTriangleContact point_triangle_contact(const SurfaceTables& surface, std::span<const Vec3> position,
                                            const Vec3& point, Index triangle, const PairScale& scale, Real near,
                                            Surfaces surfaces);

/// True if a vertex of a surface touches the axis of a capsule: no face around the vertex comes nearer to the nearest
/// point of the axis. A small tilt of the axis is allowed. `offset`: vector from the vertex to this point of the axis
/// [m].
bool vertex_holds_axis(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex, const Vec3& offset,
                       const Vec3& axis, const PairScale& scale);

/// True if a vertex of a surface can touch a point: no face around the vertex comes nearer to this point. `offset`:
/// vector from the vertex to the point [m].
bool vertex_holds_place(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex, const Vec3& offset,
                        const PairScale& scale);

}  // namespace skerry
