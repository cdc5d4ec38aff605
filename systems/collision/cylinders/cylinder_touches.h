// Places where a cylinder and another shape may touch first (docs/methods/rigid_bodies.md 6.3).
#pragma once

#include <array>

#include "components/check.h"
#include "components/collider_table.h"
#include "systems/collision/colliders/collider_shape.h"

namespace skerry {

/// A possible touch, in the frame of the cylinder.
struct CylinderTouch {
    Index number;                  // identifies the touch from step to step; ascending in a list
    Real distance;                 // signed [m]
    Vec3 normal;                   // unit, from the other shape to the cylinder
    Vec3 on_other;                 // on the surface of the other shape [m]
    std::array<Real, 2> weight{};  // of the ends of a capsule's axis
};

/// The touches of one pair or of one triangle, with room for as many as there can be.
class CylinderTouches {
public:
    static constexpr Index most = 256;  // numbers are below this

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

/// Points of the rims of a cylinder that can touch a flat side whose outward unit normal in the frame of the cylinder
/// is `normal`. Each rim has the point that reaches furthest towards the side and, where an end nearly faces the side,
/// some points that support it there. None of them comes nearer to the side when the cylinder turns about its axis by
/// less than a radian per step; a point that turns with the cylinder would.
struct RimPoints {
    static constexpr Index most_of_rim = 9;
    struct Point {
        Index number;  // below 2 * most_of_rim
        Vec3 at;       // [m]
    };
    std::array<Point, 2 * most_of_rim> point;
    std::size_t count = 0;

    RimPoints(const ColliderGeometry& cylinder, const Vec3& normal);
    const Point* begin() const { return point.data(); }
    const Point* end() const { return point.data() + count; }
};

/// Kind of surface of a cylinder at the place where its distance has the given gradient.
enum class CylinderPlace : std::uint8_t { end, side, rim };
CylinderPlace place_of(const Vec3& gradient);

/// Touch with the ball of radius `radius` around `middle`. It is left out if further than `near` [m].
void touch_ball(const ColliderGeometry& cylinder, const Vec3& middle, Real radius, Real near, CylinderTouches& found);

/// Touches with a capsule whose axis runs from `a` to `b`. Touches further than `near` are left out [m].
void touch_capsule(const ColliderGeometry& cylinder, const Vec3& a, const Vec3& b, Real radius, Real near,
                   CylinderTouches& found);

/// Touches with a part of another shape, no mesh, at `place` in the frame of the cylinder. Touches further than `near`
/// are left out [m].
void touch_shape(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part, const RigidMotion& place,
                 Real near, CylinderTouches& found);

/// Lower bound of the distance of a triangle, given in the frame of the cylinder [m].
Real distance_bound(const ColliderGeometry& cylinder, const LocalFace& face);

/// Two planes across `normal` (unit, towards the cylinder, in its frame) that lie `distance` apart [m] separate the
/// cylinder from a shape. If the normal is zero, bounding balls or capsules do.
struct Separation {
    Real distance;
    Vec3 normal;
};

/// Best separation from a part of a shape at `place` in the frame of the cylinder: a lower bound of the distance of its
/// convex hull. It uses the axes of both shapes and the normals of the touches, and the bounding balls.
Separation shape_separation(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part,
                            const RigidMotion& place, const CylinderTouches& touches);

}  // namespace skerry
