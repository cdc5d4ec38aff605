// Where a cylinder and something else may touch first (docs/methods/rigid_bodies.md 6.3).
#pragma once

#include <array>

#include "components/check.h"
#include "components/collider_table.h"

namespace skerry {

/// All in the frame of the cylinder.
struct CylinderTouch {
    Index number;                  // which one it is, from step to step; ascending in a list
    Real distance;                 // m, signed
    Vec3 normal;                   // unit, from the other to the cylinder
    Vec3 on_other;                 // m, on the surface of the other
    std::array<Real, 2> weight{};  // of a capsule's ends
};

/// Of one pair, or of one triangle. As many as there can be.
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

/// Points of the rims of a cylinder for a flat side of something else whose outward unit normal in the frame of the
/// cylinder is `normal`: of either rim the point that reaches furthest towards it, and where an end nearly faces the
/// side some that hold it there. None of those comes nearer to the side by a turn about the axis that takes less than
/// a radian a step, as a point that turns with the cylinder would.
struct RimPoints {
    static constexpr Index most_of_rim = 9;
    struct Point {
        Index number;  // below 2 most_of_rim
        Vec3 at;       // m
    };
    std::array<Point, 2 * most_of_rim> point;
    std::size_t count = 0;

    RimPoints(const ColliderGeometry& cylinder, const Vec3& normal);
    const Point* begin() const { return point.data(); }
    const Point* end() const { return point.data() + count; }
};

/// How the surface of a cylinder is at the place with a gradient of its distance.
enum class CylinderPlace : std::uint8_t { end, side, rim };
CylinderPlace place_of(const Vec3& gradient);

/// Of the ball of a radius around a point.
void touch_ball(const ColliderGeometry& cylinder, const Vec3& middle, Real radius, Real near, CylinderTouches& found);

/// Of a capsule with an axis from `a` to `b`.
void touch_capsule(const ColliderGeometry& cylinder, const Vec3& a, const Vec3& b, Real radius, Real near,
                   CylinderTouches& found);

/// Of a part of another shape that is at `place` in the frame of the cylinder, no mesh: what is nearer than `near`.
void touch_shape(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part, const RigidMotion& place,
                 Real near, CylinderTouches& found);

}  // namespace skerry
