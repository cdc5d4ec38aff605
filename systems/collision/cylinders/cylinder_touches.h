// Points where a cylinder and another shape may touch first (docs/methods/rigid_bodies.md 6.3).
#pragma once

#include <array>

#include "components/check.h"
#include "components/collider_table.h"
#include "systems/collision/colliders/collider_shape.h"

namespace skerry {

/// A possible touching point, in the frame of the cylinder.
struct CylinderTouch {
    Index number;                  // identifies the touching point from step to step; ascending in a list
    Real distance;                 // signed [m]
    Vec3 normal;                   // unit normal from the other shape to the cylinder
    Vec3 on_other;                 // touching point on the surface of the other shape [m]
    std::array<Real, 2> weight{};  // weights of the two ends of a capsule's axis
};

/// List of the touching points of one pair or of one triangle. The capacity suffices for the greatest possible number.
class CylinderTouches {
public:
    static constexpr Index most = 256;  // capacity, and upper limit of the touch numbers

    void clear() { count_ = 0; }
    void add(const CylinderTouch& touch) {
        SKERRY_CHECK(count_ < static_cast<std::size_t>(most));
        touch_[count_++] = touch;
    }
    const CylinderTouch* begin() const { return touch_.data(); }
    const CylinderTouch* end() const { return touch_.data() + count_; }

private:
    std::array<CylinderTouch, most> touch_;
    std::size_t count_ = 0;
};

/// Points of the rims of a cylinder that can touch a flat side. `normal`: outward unit normal of the side in the frame
/// of the cylinder. Each rim has the point that reaches furthest towards the side. If an end of the cylinder nearly
/// faces the side, its rim also has points that support the end on the side. None of these points comes nearer to the
/// side when the cylinder rotates about its axis by less than a radian per step. For a tilted end, points that rotate
/// with the cylinder would come nearer.
struct RimPoints {
    static constexpr Index most_of_rim = 9;
    struct Point {
        Index number;  // less than 2 * most_of_rim
        Vec3 at;       // [m]
    };
    std::array<Point, 2 * most_of_rim> point;
    std::size_t count = 0;

    RimPoints(const ColliderGeometry& cylinder, const Vec3& normal);
    const Point* begin() const { return point.data(); }
    const Point* end() const { return point.data() + count; }
};

/// Kind of the cylinder surface nearest to a point, from the gradient of the cylinder's distance at this point.
enum class CylinderPlace : std::uint8_t { end, side, rim };
CylinderPlace place_of(const Vec3& gradient);

/// Adds the touching point with the sphere of radius `radius` around `middle`, unless its distance exceeds `near` [m].
void touch_ball(const ColliderGeometry& cylinder, const Vec3& middle, Real radius, Real near, CylinderTouches& found);

/// Adds the touching points with a capsule whose axis runs from `a` to `b`, if their distance is at most `near` [m].
void touch_capsule(const ColliderGeometry& cylinder, const Vec3& a, const Vec3& b, Real radius, Real near,
                   CylinderTouches& found);

/// Adds the touching points with a part of another shape, which must not be a mesh, if their distance is at most `near`
/// [m]. `place`: pose of the shape in the frame of the cylinder.
void touch_shape(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part, const RigidMotion& place,
                 Real near, CylinderTouches& found);

/// Lower bound of the distance between the cylinder and a triangle, which is given in the frame of the cylinder [m].
Real distance_bound(const ColliderGeometry& cylinder, const LocalFace& face);

/// Lower bound of the distance between the cylinder and the convex hull of a part of another shape [m]: the greatest
/// distance of parallel planes that separate both, along the axes of both shapes and the normals of `touches`, or of
/// bounding spheres. `place`: pose of the other shape in the frame of the cylinder.
Real shape_distance_bound(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part,
                          const RigidMotion& place, const CylinderTouches& touches);

}  // namespace skerry
