// What of a collider touches where a body has no node: its points, and where its surface is flat.
#pragma once

#include <span>

#include "components/collider_table.h"

namespace skerry {

/// A point of a collider that may touch a face of a body between its nodes: the corner of a box, the middle of a ball
/// or of the end of a capsule, a point of the rim of a cylinder or bucket.
struct ColliderPoint {
    Vec3 at;      // m, in the frame of the collider
    Real radius;  // m, of the ball around it that is solid
};

/// Points with numbers from 0 to below this; none of a plane, or of a mesh, which has nodes of its own.
Index collider_point_count(ColliderShape shape);

/// Point k for a face whose outward unit normal in the frame of the collider is `normal`: of a rim the point that is
/// deepest behind the face, and four that stand still. Others do not depend on the face.
ColliderPoint collider_point(const ColliderGeometry& geometry, Index k, const Vec3& normal);

/// Whether the point of that number is another one for another face.
bool collider_point_follows(ColliderShape shape, Index k);

/// Where a shape is flat, or hollow, the distance along a segment or triangle is least at one of its corners: only
/// nodes touch. Such a place has a number: of a box the six faces, of a cylinder both ends, of a bucket its hollow and
/// what is below it. The place in which a point may move furthest; no_index when there is none.
Index flat_place(const ColliderGeometry& geometry, const Vec3& point);

/// How far a point may move, in the frame of the collider, and still be in that place, m; below zero outside of it.
Real flat_reach(const ColliderGeometry& geometry, Index place, const Vec3& point);

/// How far all of the points may move and still be in one place, m; below zero when they are in none.
Real flat_reach(const ColliderGeometry& geometry, std::span<const Vec3> points);

/// The signed distance of a convex shape lies above its tangents.
struct HullTangent {
    Vec3 at, normal;
    Real distance;  // m, of `at`

    /// The distance of a point to the shape is no smaller than this, m.
    Real bound(const Vec3& point) const { return distance + normal.dot(point - at); }
};

/// To the convex shape around a collider, which is it itself unless it is a bucket.
HullTangent hull_tangent(const ColliderGeometry& geometry, const Vec3& at);

/// No point of the convex hull of `points` is nearer to the shape than this, m: by the tangent in their middle.
Real hull_distance(const ColliderGeometry& geometry, std::span<const Vec3> points);

}  // namespace skerry
