// Points of a collider that can touch a face of a body between the nodes of the face, and flat regions of a collider in
// which only nodes can touch.
#pragma once

#include <array>
#include <span>

#include "components/collider_table.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

/// A point of a collider that may touch a face of a body between the nodes of the face. The point is a corner of a box,
/// the centre of a sphere, the centre of an end of a capsule, or a point on the rim of a cylinder or bucket.
struct ColliderPoint {
    Vec3 at;      // position in the frame of the collider [m]
    Real radius;  // radius of the solid ball around the point; 0 for a corner or a rim point [m]
};

/// Number of points of a collider that may touch a face; the points are numbered from 0. A plane has no such points. A
/// mesh has none, because the nodes of the mesh are tested.
Index collider_point_count(ColliderShape shape);

/// Point k of a collider for a test against a face with the outward unit normal `normal`, both in the frame of the
/// collider. Only the first of the five points of a rim depends on `normal`: it is the rim point furthest behind the
/// plane of the face.
ColliderPoint collider_point(const ColliderGeometry& geometry, Index k, const Vec3& normal);

/// True if point k is the first point of a rim: its position depends on the normal of the face (collider_point).
bool is_moving_rim_point(ColliderShape shape, Index k);

/// Index of the flat region in which `point` can move furthest before it leaves the region (flat_reach); no_index if
/// the shape has no flat region.
///
/// A flat region is a volume at a flat or hollow side of a shape, in which the signed distance is a linear or concave
/// function. On a segment or triangle in it, the distance is therefore least at an end or corner, so only nodes can
/// touch. A plane has one region, a box six (one at each face), a cylinder two (at its ends), a bucket two (inside and
/// below).
Index flat_region(const ColliderGeometry& geometry, const Vec3& point);

/// Distance that a point can move in the frame of the collider while it stays in the flat region `region` [m]. The
/// distance is negative if the point is outside of this region.
Real flat_reach(const ColliderGeometry& geometry, Index region, const Vec3& point);

/// Distance that all points can move while they stay in the same flat region [m]; negative if no flat region contains
/// all points.
Real flat_reach(const ColliderGeometry& geometry, std::span<const Vec3> points);

/// Linear approximation of the signed distance from a convex shape at the point `at`. The signed distance from a convex
/// shape is a convex function, so the approximation is a lower bound everywhere.
struct HullTangent {
    Vec3 at, normal;
    Real distance;  // signed distance of the point `at` from the shape [m]

    /// Lower bound of the signed distance of `point` from the shape [m].
    Real bound(const Vec3& point) const { return distance + normal.dot(point - at); }
};

/// HullTangent at the point `at` for a convex shape that contains the collider. The convex shape is the collider
/// itself, except for a bucket.
HullTangent hull_tangent(const ColliderGeometry& geometry, const Vec3& at);

/// Lower bound of the distance between the shape and the convex hull of `points` [m]. It is the least value of
/// HullTangent::bound at the points, with the tangent taken at their mean.
Real hull_distance(const ColliderGeometry& geometry, std::span<const Vec3> points);

/// Corners of a triangle in the frame of the collider, counter-clockwise as seen from outside the body.
using LocalFace = std::array<Vec3, 3>;

struct FaceContact {
    // Lower bound of the distance between the face and the ball of radius point.radius around the collider point [m].
    // The first point of a rim moves along the rim if the face rotates; for this point, `nearest` bounds the distance
    // between the face and the complete collider.
    Real nearest;
    bool above;  // true: the projection of the collider point on the plane of the face is inside the face
    // Signed distance of the ball around the collider point from the plane of the face; negative behind the plane [m].
    Real distance;
    Vec3 normal;            // outward unit normal of the face
    ColliderPoint point;    // the tested point of the collider
    PointTriangle closest;  // point of the face nearest to `point.at`
};

/// Tests a face of a body against point k of a collider. The test finds contacts in the interior of the face.
FaceContact face_contact(const ColliderGeometry& geometry, Index k, const LocalFace& face);

}  // namespace skerry
