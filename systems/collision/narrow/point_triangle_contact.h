// A point against a triangle of a closed surface (docs/methods/collision.md 4.1 to 4.3).
#pragma once

#include <span>

#include "components/surface_table.h"
#include "systems/collision/inputs/contact_reach.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

enum class Side : std::uint8_t {
    none,     // no contact by this triangle: a neighbour owns it, or the point is out of its way
    outside,  // a contact
    behind,   // a contact if no other triangle of the body is nearer to the point
};

/// What is known of two surfaces. Where they are apart a point behind a triangle has not come through it: the body is
/// thin or folded there, or an element has turned inside out, and the point stays behind. Where they may overlap it is
/// pushed out to the front.
enum class Surfaces : std::uint8_t { apart, may_overlap };

struct PointTriangleContact {
    Side side = Side::none;
    Real distance = 0;  // m, signed
    Vec3 normal;        // unit, out of the triangle's body, or away from its back
    PointTriangle closest;
    Real sleep = 0;  // m: travel after which this may be a contact of gap 0; not above 0: look again in the next step
};

/// The point against the feature of the triangle that is nearest to it. A point that is nearest to an edge or a vertex
/// is left to the lowest triangle around it, and is a contact only where no other triangle around comes nearer.
/// Normals: of the face; from the edge or vertex to the point, or, too near for that, the mean of the faces around.
/// The core of a round body is touched from all sides. Features further than `near` are not looked at closely.
PointTriangleContact point_triangle_contact(const SurfaceTables& surface, std::span<const Vec3> position,
                                            const Vec3& point, Index triangle, const PairScale& scale, Real near,
                                            Surfaces surfaces);

/// Whether a vertex holds the axis of a capsule whose nearest place is at `offset` from it: no face around it comes
/// nearer to that place, but for a little tilt of the axis.
bool vertex_holds_axis(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex, const Vec3& offset,
                       const Vec3& axis, const PairScale& scale);

/// Whether a vertex holds a place at `offset` from it: no face around it comes nearer to that place.
bool vertex_holds_place(const SurfaceTables& surface, std::span<const Vec3> position, Index vertex, const Vec3& offset,
                        const PairScale& scale);

}  // namespace skerry
