// Contact of a point with a triangle of a closed surface (docs/methods/collision.md 4.1 to 4.3).
#pragma once

#include <span>

#include "components/surface_table.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

enum class Side : std::uint8_t {
    none,     // no contact with this triangle: the point belongs to a neighbouring triangle or is too far away
    outside,  // contact in front of the triangle
    behind,   // contact behind the triangle, provided that no other triangle of the body is nearer to the point
};

/// State of two surfaces. apart: the surfaces have not passed through each other. A point may still lie behind a
/// triangle of a thin or folded body, or of an inverted element; then the point must stay behind this triangle.
/// may_overlap: the surfaces may have passed through each other, so a point behind a triangle is pushed out to the
/// front.
enum class Surfaces : std::uint8_t { apart, may_overlap };

struct PointTriangleContact {
    Side side = Side::none;
    Real distance = 0;  // distance between point and triangle; negative behind it if the surfaces may overlap [m]
    Vec3 normal;        // unit normal, pointing away from the triangle on the side where the point must stay
    PointTriangle closest;
    // Travel of the pair, counted from now, up to which the point and the triangle cannot touch [m]. If the value is
    // not positive, the candidate is tested again in the next step.
    Real sleep = 0;
};

/// Tests a point against the part of a triangle that is nearest to it: the face, an edge or a vertex. If the distance
/// exceeds both `contact_limit` and scale.zone, only `closest` and `sleep` are computed.
///
/// An edge or vertex belongs to several triangles, but if it is nearest, only one of them reports the contact: the one
/// with the lowest row. None reports a contact if one of the faces at this edge or vertex is nearer to the point. The
/// normal is the normal of the face, or points from the edge or vertex to the point. If the point is too close to the
/// edge or vertex for an accurate direction, the normal is the mean of the normals of the adjacent faces. The core of a
/// round body can be touched from all sides.
PointTriangleContact point_triangle_contact(const SurfaceTables& surface, std::span<const Vec3> position,
                                            const Vec3& point, Index triangle, const PairScale& scale,
                                            Real contact_limit, Surfaces surfaces);

/// True if a vertex of a surface can touch a capsule or the curved side of a cylinder. Let p be the point of the axis
/// that is nearest to the vertex. The vertex can touch if no face at the vertex is nearer to p than the vertex is. As a
/// tolerance, it suffices that this holds for at least one tilt of the axis by at most axis_tilt. `offset`: vector from
/// the vertex to p [m]. `axis`: direction of the axis.
bool vertex_can_touch_axis(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex,
                           const Vec3& offset, const Vec3& axis, const PairScale& scale);

/// True if a vertex of a surface can touch a point, because no face at the vertex is nearer to this point than the
/// vertex. `offset`: vector from the vertex to the point [m].
bool vertex_can_touch_point(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex,
                            const Vec3& offset, const PairScale& scale);

}  // namespace skerry
