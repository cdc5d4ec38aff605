// Points of a collider that can touch a body between its nodes, and flat regions of a collider in which only nodes can
// touch.
#pragma once

#include <array>
#include <span>

#include "components/collider_table.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

/// A point of a collider that may touch a face of a body between the nodes of the face: a corner of a box, the centre
/// of a sphere or of the end of a capsule, or a point on the rim of a cylinder or bucket.
struct ColliderPoint {
    Vec3 at;      // position in the frame of the collider [m]
    Real radius;  // radius of the solid ball around it [m]
};

/// Number of points of a collider that may touch a face, numbered from 0. A plane has no such points. A mesh has none,
/// because its own nodes are tested.
Index collider_point_count(ColliderShape shape);

/// Point k of a collider for a face with the outward unit normal `normal` in the frame of the collider. A rim has one
/// point that depends on the face, because it is the rim point deepest behind the face, and four fixed points. Points
/// of other shapes do not depend on the face.
ColliderPoint collider_point(const ColliderGeometry& geometry, Index k, const Vec3& normal);

/// True if the position of point k depends on the face.
bool collider_point_follows(ColliderShape shape, Index k);

/// Index of the flat region of a shape in which a point can move furthest, or no_index if the shape has none. A flat
/// region is near a flat or hollow side of the shape. There the distance along a segment or triangle is least at a
/// corner, so that only nodes can touch. A plane has one region, a box its six faces, a cylinder both ends, and a
/// bucket its hollow and the region below it.
Index flat_place(const ColliderGeometry& geometry, const Vec3& point);

/// Distance a point can move in the frame of the collider while it stays in the flat region `place` [m]; negative
/// outside of this region.
Real flat_reach(const ColliderGeometry& geometry, Index place, const Vec3& point);

/// Distance all points can move while they stay in one flat region [m]; negative if no region contains all of them.
Real flat_reach(const ColliderGeometry& geometry, std::span<const Vec3> points);

/// Tangent plane of the signed distance function of a convex shape at a point. The signed distance is nowhere below
/// this plane.
struct HullTangent {
    Vec3 at, normal;
    Real distance;  // signed distance of the shape at `at` [m]

    /// Lower bound of the signed distance of the shape at `point` [m].
    Real bound(const Vec3& point) const { return distance + normal.dot(point - at); }
};

/// Tangent plane at `at` for a convex shape that contains the collider. This shape is the collider itself, except for a
/// bucket.
HullTangent hull_tangent(const ColliderGeometry& geometry, const Vec3& at);

/// Lower bound of the distance between the shape and the convex hull of `points` [m]. It uses the tangent plane at the
/// mean of the points.
Real hull_distance(const ColliderGeometry& geometry, std::span<const Vec3> points);

/// Corners of a triangle in the frame of the collider, counter-clockwise as seen from outside of the body.
using LocalFace = std::array<Vec3, 3>;

struct FaceContact {
    // Lower bound of the distance between the face and the point [m]. If the point depends on the face, it bounds the
    // distance between the face and the whole collider.
    Real nearest;
    bool above;             // true if the point is in front of or behind the face, not beside it
    Real distance;          // signed distance of the collider point from the plane of the face; negative behind it [m]
    Vec3 normal;            // outward unit normal of the face
    ColliderPoint point;    // of the collider
    PointTriangle closest;  // point of the face nearest to `point.at`
};

/// Tests a face of a body against point k of a collider for a contact between the nodes and edges of the face.
FaceContact face_contact(const ColliderGeometry& geometry, Index k, const LocalFace& face);

}  // namespace skerry
