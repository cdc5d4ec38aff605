#include "systems/collision/query/surface_query.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "systems/collision/tree/box.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

constexpr Real rounding = 16 * std::numeric_limits<Real>::epsilon();

/// A ray, sheared so that it is parallel to the axis of its largest component. The sign of one 2x2 determinant then
/// shows on which side of an edge the ray passes. No ray passes between the two triangles at an edge, because both
/// compute this determinant with the same rounding errors.
class ShearedRay {
public:
    explicit ShearedRay(const Ray& ray) : ray_(ray) {
        ray.direction.cwiseAbs().maxCoeff(&z_);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        shear_ = Vec3(ray.direction[x_], ray.direction[y_], 1) / ray.direction[z_];
    }

    /// Intersection of the ray with a triangle. No value if the ray misses the triangle or lies in the plane of the
    /// triangle.
    std::optional<TrianglePoint> meet(Index triangle, const Vec3& a, const Vec3& b, const Vec3& c) const {
        const Vec3 A = sheared(a), B = sheared(b), C = sheared(c);
        const Real u = C.x() * B.y() - C.y() * B.x(), v = A.x() * C.y() - A.y() * C.x(),
                   w = B.x() * A.y() - B.y() * A.x();
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
        const Real sum = u + v + w;
        if (sum == 0) return std::nullopt;
        const Real distance = (u * A.z() + v * B.z() + w * C.z()) / sum;
        if (!(distance >= 0)) return std::nullopt;
        return TrianglePoint{triangle, {u / sum, v / sum, w / sum}, distance};
    }

    /// True if the ray may hit an object inside a box at a distance of at most `limit` [m]. The test has a tolerance
    /// for rounding errors.
    bool may_meet(const Aabb& box, Real limit) const {
        Real near = 0, far = limit;
        for (int i = 0; i < 3; ++i) {
            const Real d = ray_.direction[i], lower = box.lower[i] - ray_.origin[i],
                       upper = box.upper[i] - ray_.origin[i];
            if (d == 0) {
                if (lower > 0 || upper < 0) return false;
                continue;
            }
            const Real one = lower / d, other = upper / d;
            near = std::max(near, std::min(one, other) * (1 - rounding));
            far = std::min(far, std::max(one, other) * (1 + rounding));
        }
        return near <= far * (1 + rounding);
    }

private:
    Vec3 sheared(const Vec3& point) const {
        const Vec3 p = point - ray_.origin;
        return {p[x_] - shear_.x() * p[z_], p[y_] - shear_.y() * p[z_], shear_.z() * p[z_]};
    }

    const Ray& ray_;
    int x_, y_, z_ = 0;
    Vec3 shear_;
};

/// Stores the nearest point found so far. If several points are equally near, the point on the triangle with the lowest
/// row is stored.
class Nearest {
public:
    explicit Nearest(Real limit) : limit_(limit) {}

    void take(const std::optional<TrianglePoint>& found) {
        if (!found || !(found->distance <= limit_)) return;
        if (best_ && found->distance == best_->distance && found->triangle > best_->triangle) return;
        best_ = found;
        limit_ = found->distance;
    }
    Real limit() const { return limit_; }
    const std::optional<TrianglePoint>& best() const { return best_; }

private:
    Real limit_;
    std::optional<TrianglePoint> best_;
};

/// Calls visit(triangle) for the triangles in all leaves of a tree, except for leaves below a node whose box does not
/// satisfy worth(box).
void for_each_triangle(const SurfaceTree& surface, auto&& worth, auto&& visit) {
    for (Index row = surface.tree.begin; row < surface.tree.end;) {
        const auto r = static_cast<std::size_t>(row);
        const BvhNode& node = surface.node[r];
        if (!worth(surface.box[r])) {
            row = node.skip;
            continue;
        }
        if (node.leaf != no_index)
            for (Index i = 0; i < node.count; ++i)
                visit(surface.leaf_triangle[static_cast<std::size_t>(node.leaf)][static_cast<std::size_t>(i)]);
        ++row;
    }
}

std::array<Vec3, 3> corners_of(const SurfaceTree& surface, Index triangle) {
    const auto& [a, b, c] = surface.triangle_node[static_cast<std::size_t>(triangle)];
    return {surface.position[static_cast<std::size_t>(a)], surface.position[static_cast<std::size_t>(b)],
            surface.position[static_cast<std::size_t>(c)]};
}

void meet(const SurfaceTree& surface, const ShearedRay& ray, Index triangle, Nearest& nearest) {
    const auto [a, b, c] = corners_of(surface, triangle);
    nearest.take(ray.meet(triangle, a, b, c));
}

void approach(const SurfaceTree& surface, const Vec3& point, Index triangle, Nearest& nearest) {
    const auto [a, b, c] = corners_of(surface, triangle);
    const PointTriangle found = closest_point_on_triangle(point, a, b, c);
    nearest.take(TrianglePoint{triangle, found.weight, std::sqrt(found.distance_squared)});
}

}  // namespace

std::optional<TrianglePoint> cast_ray(const SurfaceTree& surface, const Ray& ray, Real limit) {
    const ShearedRay sheared(ray);
    Nearest nearest(limit);
    for_each_triangle(
        surface, [&](const Aabb& box) { return sheared.may_meet(box, nearest.limit()); },
        [&](Index triangle) { meet(surface, sheared, triangle, nearest); });
    return nearest.best();
}

std::optional<TrianglePoint> nearest_point(const SurfaceTree& surface, const Vec3& point, Real limit) {
    Nearest nearest(limit);
    for_each_triangle(
        surface,
        [&](const Aabb& box) { return std::sqrt(distance_squared(box, point)) <= nearest.limit() * (1 + rounding); },
        [&](Index triangle) { approach(surface, point, triangle, nearest); });
    return nearest.best();
}

}  // namespace skerry
