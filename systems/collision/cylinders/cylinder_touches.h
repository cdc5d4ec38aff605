// Points where a cylinder and another shape may touch first (docs/methods/rigid_bodies.md 6.3).
#pragma once

#include <array>

#include "components/check.h"
#include "components/collider_table.h"
#include "systems/collision/colliders/collider_shape.h"

namespace skerry {

/// A possible contact point, in the frame of the cylinder.
struct CylinderTouch {
    Index number;   // number that identifies the contact point across steps; ascending in a list
    Real distance;  // signed distance between the two shapes at this point [m]
    Vec3 normal;    // unit normal, directed from the other shape to the cylinder
    Vec3 on_other;  // contact point on the surface of the other shape [m]
    // weights of both ends of the axis if the other shape is a capsule; {1, 0} for a sphere
    std::array<Real, 2> weight{};
};

/// Contact points of one pair of shapes, or of the cylinder and one triangle. The capacity suffices for the greatest
/// possible number of contact points.
class CylinderTouches {
public:
    static constexpr Index capacity = 256;  // capacity of the list; every CylinderTouch::number is below it

    void clear() { count_ = 0; }
    void add(const CylinderTouch& touch) {
        SKERRY_CHECK(count_ < static_cast<std::size_t>(capacity));
        touch_[count_++] = touch;
    }
    const CylinderTouch* begin() const { return touch_.data(); }
    const CylinderTouch* end() const { return touch_.data() + count_; }

private:
    std::array<CylinderTouch, capacity> touch_;
    std::size_t count_ = 0;
};

/// Points on the rims of a cylinder that can touch a flat side of another shape. `normal`: outward unit normal of the
/// side in the frame of the cylinder. The points of each rim depend on the tilt of the ends against the side:
/// - above 30 degrees: the point nearest to the side
/// - up to 30 degrees: this point, and those at 90, 180 and 270 degrees from it
/// - up to 1e-4 rad: the nearest point, and eight points at fixed angles
///
/// Reason for the right angles: a contact assumes that its point moves on a straight path in a step. If a tilted
/// cylinder rotates about its axis by less than a radian, no straight path from these four points comes nearer to the
/// side than the nearest point was at the start. Paths from other angles, for example 45 degrees, could, and would
/// cause false contacts.
struct RimPoints {
    static constexpr Index max_per_rim = 9;
    struct Point {
        Index number;  // number of the point, below 2 * max_per_rim
        Vec3 at;       // [m]
    };
    std::array<Point, 2 * max_per_rim> point;
    std::size_t count = 0;

    RimPoints(const ColliderGeometry& cylinder, const Vec3& normal);
    const Point* begin() const { return point.data(); }
    const Point* end() const { return point.data() + count; }
};

/// Part of the cylinder surface nearest to a point. nearest_region determines it from the gradient, at this point, of
/// the distance from the cylinder.
enum class CylinderRegion : std::uint8_t { end, side, rim };
CylinderRegion nearest_region(const Vec3& gradient);

/// Adds the contact point with a sphere if its distance is at most `near` [m]. `middle` and `radius`: centre and radius
/// of the sphere [m].
void touch_ball(const ColliderGeometry& cylinder, const Vec3& middle, Real radius, Real near, CylinderTouches& found);

/// Adds the contact points with a capsule whose distance is at most `near` [m]. The axis of the capsule runs from `a`
/// to `b`.
void touch_capsule(const ColliderGeometry& cylinder, const Vec3& a, const Vec3& b, Real radius, Real near,
                   CylinderTouches& found);

/// Adds the contact points with a part of another shape whose distance is at most `near` [m]. The other shape must not
/// be a mesh. `pose`: pose of the other shape in the frame of the cylinder.
void touch_shape(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part, const RigidMotion& pose,
                 Real near, CylinderTouches& found);

/// Lower bound of the distance between the cylinder and a triangle [m]. `face`: the triangle in the frame of the
/// cylinder.
Real distance_bound(const ColliderGeometry& cylinder, const LocalFace& face);

/// Lower bound of the distance between the cylinder and a part of another shape [m]. `pose`: pose of the other shape in
/// the frame of the cylinder. The greatest of these bounds is returned:
/// - distance of the part from the bounding sphere of the cylinder;
/// - distance between two parallel planes that touch the cylinder and the part and have one of these directions as
///   normal: the axes of both shapes, the contact normals in `touches`;
/// - for two cylinders, distance between the capsules that contain them.
Real shape_distance_bound(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part,
                          const RigidMotion& pose, const CylinderTouches& touches);

}  // namespace skerry
