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

/// State of two surfaces.
/// - apart: they have not passed through each other. A point may still lie behind a triangle of a thin or folded body,
///   or of an inverted element, and must stay behind it.
/// - may_overlap: they may have passed through each other, so a point behind a triangle is pushed out to the front.
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
/// - An edge or vertex of several triangles makes its contact in the triangle with the lowest row. It makes none if one
///   of the faces at it is nearer to the point.
/// - The normal is that of the face, or points from the edge or vertex to the point. If the point is too close for an
///   accurate direction, it is the mean of the normals of the adjacent faces (docs/methods/collision.md 4.3).
/// - The core of a round body can be touched from all sides.
PointTriangleContact point_triangle_contact(const SurfaceTables& surface, std::span<const Vec3> position,
                                            const Vec3& point, Index triangle, const PairScale& scale,
                                            Real contact_limit, Surfaces surfaces);

/// True if a vertex of a surface can touch a capsule or the curved side of a cylinder: no face at the vertex is nearer
/// than the vertex to p, the point of the axis nearest to the vertex. It suffices that this holds for one tilt of the
/// axis by at most axis_tilt. `offset`: vector from the vertex to p [m]. `axis`: direction of the axis.
bool vertex_can_touch_axis(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex,
                           const Vec3& offset, const Vec3& axis, const PairScale& scale);

/// True if a vertex of a surface can touch a point, because no face at the vertex is nearer to this point than the
/// vertex. `offset`: vector from the vertex to the point [m].
bool vertex_can_touch_point(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex,
                            const Vec3& offset, const PairScale& scale);

}  // namespace skerry
