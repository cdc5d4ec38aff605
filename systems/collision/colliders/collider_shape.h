// Points of a collider that can touch a body between its nodes, and flat places where only nodes can touch.
#pragma once

#include <array>
#include <span>

#include "components/collider_table.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

/// A point of a collider that may touch a face of a body between its nodes: the corner of a box, the centre of a ball
/// or of the end of a capsule, or a point on the rim of a cylinder or bucket.
struct ColliderPoint {
    Vec3 at;      // position in the frame of the collider [m]
    Real radius;  // radius of the solid ball around it [m]
};

/// Number of the points, which are numbered from 0. A plane has none, nor has a mesh, which has nodes of its own.
Index collider_point_count(ColliderShape shape);

/// Point k for a face whose outward unit normal in the frame of the collider is `normal`. A rim has one point that
/// follows the face, the deepest behind it, and four fixed ones. Other points do not depend on the face.
ColliderPoint collider_point(const ColliderGeometry& geometry, Index k, const Vec3& normal);

/// True if the position of point k depends on the face.
bool collider_point_follows(ColliderShape shape, Index k);

/// Place in which a point can move furthest, or no_index if the shape has none. In a flat place the shape is flat or
/// hollow: the distance along a segment or triangle is least at a corner, so that only nodes touch. A plane has one
/// place, a box its six faces, a cylinder both ends, a bucket its hollow and the region below it.
Index flat_place(const ColliderGeometry& geometry, const Vec3& point);

/// Distance a point can move in the frame of the collider while staying in that place; negative outside of it [m].
Real flat_reach(const ColliderGeometry& geometry, Index place, const Vec3& point);

/// Distance all points can move while staying in the same flat place; negative if no place contains all of them [m].
Real flat_reach(const ColliderGeometry& geometry, std::span<const Vec3> points);

/// Tangent plane of the signed distance of a convex shape. The signed distance is nowhere below it.
struct HullTangent {
    Vec3 at, normal;
    Real distance;  // signed distance of `at` [m]

    /// Lower bound of the signed distance of a point to the shape [m].
    Real bound(const Vec3& point) const { return distance + normal.dot(point - at); }
};

/// Tangent plane for a convex shape around a collider. That shape is the collider itself unless it is a bucket.
HullTangent hull_tangent(const ColliderGeometry& geometry, const Vec3& at);

/// Lower bound of the distance of the shape from the convex hull of `points`, by the tangent at their mean [m].
Real hull_distance(const ColliderGeometry& geometry, std::span<const Vec3> points);

/// The corners of a triangle in the frame of the collider, counter-clockwise seen from outside of the body.
using LocalFace = std::array<Vec3, 3>;

struct FaceContact {
    // lower bound of the distance of the face to the point, or to the whole collider if the point follows the face [m]
    Real nearest;
    bool above;             // true if the point is over or behind the face, not beside it
    Real distance;          // signed distance from the face to the collider; negative behind the face [m]
    Vec3 normal;            // outward unit normal of the face
    ColliderPoint point;    // of the collider
    PointTriangle closest;  // point of the face nearest to `point.at`
};

/// Contact of a face of a body with point k of a collider, between the nodes and edges of the face.
FaceContact face_contact(const ColliderGeometry& geometry, Index k, const LocalFace& face);

}  // namespace skerry
