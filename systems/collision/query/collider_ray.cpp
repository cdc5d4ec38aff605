#include "systems/collision/query/collider_ray.h"

#include <cmath>

#include "components/check.h"

namespace skerry {

namespace {

/// Intersects a ray with the pieces of a shape's surface, in the coordinate frame of the shape, and stores the nearest
/// hit.
class Pieces {
public:
    Pieces(const Ray& ray, Real limit) : ray_(ray), limit_(limit) {}

    /// Intersects the ray with the flat ring z = height, inner <= r <= outer, where r is the distance from the z axis.
    /// `up`: z component of the outward normal, 1 or -1.
    void ring(Real height, Real inner, Real outer, Real up) {
        flat(2, height, up, [&](const Vec3& p) {
            const Real squared = p.x() * p.x() + p.y() * p.y();
            return squared <= outer * outer && squared >= inner * inner;
        });
    }
    /// Intersects the ray with the plane in which the coordinate `axis` has the value `at`. A hit at `point` counts
    /// only if belongs(point) is true. `side`: component of the outward normal along the axis, 1 or -1.
    void flat(int axis, Real at, Real side, auto&& belongs) {
        if (ray_.direction[axis] == 0) return;
        const Real t = (at - ray_.origin[axis]) / ray_.direction[axis];
        if (belongs(Vec3(ray_.origin + t * ray_.direction))) take(t, side * Vec3::Unit(axis));
    }
    /// Intersects the ray with the curved side of a cylinder around the z axis, for z0 <= z <= z1. `side`: -1 if the
    /// outward normal points to the axis, otherwise 1.
    void tube(Real radius, Real z0, Real z1, Real side) {
        const Vec3 across(ray_.direction.x(), ray_.direction.y(), 0);
        roots(Vec3(ray_.origin.x(), ray_.origin.y(), 0), across, radius, [&](Real t) {
            const Vec3 p = ray_.origin + t * ray_.direction;
            if (p.z() >= z0 && p.z() <= z1) take(t, side * Vec3(p.x(), p.y(), 0) / radius);
        });
    }
    /// Intersects the ray with a sphere around (0, 0, height). `up`: 1 for the upper half of the sphere, -1 for the
    /// lower half, 0 for the complete sphere.
    void ball(Real height, Real radius, Real up) {
        const Vec3 centre(0, 0, height);
        roots(ray_.origin - centre, ray_.direction, radius, [&](Real t) {
            const Vec3 p = ray_.origin + t * ray_.direction - centre;
            if (up * p.z() >= 0) take(t, p / radius);
        });
    }

    const std::optional<ShapePoint>& nearest() const { return nearest_; }

private:
    void take(Real t, const Vec3& normal) {
        if (!(t >= 0 && t <= limit_) || (nearest_ && !(t < nearest_->distance))) return;
        nearest_ = {t, normal};
    }
    /// Calls found(t) for each t with |origin + t direction| = radius. The solutions are computed relative to the point
    /// of the ray nearest to the centre. A ray that starts far away thus loses no accuracy by cancellation.
    static void roots(const Vec3& origin, const Vec3& direction, Real radius, auto&& found) {
        const Real squared = direction.squaredNorm();
        if (squared == 0) return;
        const Real middle = -origin.dot(direction) / squared;
        const Real rest = radius * radius - (origin + middle * direction).squaredNorm();
        if (!(rest >= 0)) return;
        const Real half = std::sqrt(rest / squared);
        found(middle - half);
        found(middle + half);
    }

    const Ray& ray_;
    Real limit_;
    std::optional<ShapePoint> nearest_;
};

void add_box(const Vec3& half, Pieces& pieces) {
    for (int axis = 0; axis < 3; ++axis)
        for (const Real side : {-1.0, 1.0})
            pieces.flat(axis, side * half[axis], side, [&](const Vec3& p) {
                const int a = (axis + 1) % 3, b = (axis + 2) % 3;
                return std::abs(p[a]) <= half[a] && std::abs(p[b]) <= half[b];
            });
}

void add_bucket(Real inner, Real height, Real wall, Pieces& pieces) {
    pieces.tube(inner + wall, -wall, height, 1);
    pieces.tube(inner, 0, height, -1);
    pieces.ring(height, inner, inner + wall, 1);
    pieces.ring(0, 0, inner, 1);
    pieces.ring(-wall, 0, inner + wall, -1);
}

}  // namespace

std::optional<ShapePoint> cast_ray(const ColliderGeometry& geometry, const RigidMotion& motion, const Ray& ray,
                                   Real limit) {
    const Mat3 inverse = motion.rotation.transpose();
    const Ray own{inverse * (ray.origin - motion.position), inverse * ray.direction};
    const Vec3& size = geometry.size;
    Pieces pieces(own, limit);
    switch (geometry.shape) {
        case ColliderShape::plane:
            pieces.flat(2, 0, 1, [](const Vec3&) { return true; });
            break;
        case ColliderShape::sphere:
            pieces.ball(0, size[0], 0);
            break;
        case ColliderShape::box:
            add_box(size, pieces);
            break;
        case ColliderShape::capsule:
            pieces.tube(size[0], -size[1], size[1], 1);
            pieces.ball(size[1], size[0], 1);
            pieces.ball(-size[1], size[0], -1);
            break;
        case ColliderShape::cylinder:
            pieces.tube(size[0], -size[1], size[1], 1);
            pieces.ring(size[1], 0, size[0], 1);
            pieces.ring(-size[1], 0, size[0], -1);
            break;
        case ColliderShape::bucket:
            add_bucket(size[0], size[1], size[2], pieces);
            break;
        case ColliderShape::mesh:
            SKERRY_CHECK(false);  // the triangles of a mesh are tested instead (surface_query.h)
            break;
    }
    if (!pieces.nearest()) return std::nullopt;
    return ShapePoint{pieces.nearest()->distance, motion.rotation * pieces.nearest()->normal};
}

}  // namespace skerry
