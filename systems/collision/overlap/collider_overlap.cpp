#include "systems/collision/overlap/collider_overlap.h"

#include <limits>

#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/tree/box.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

/// A point inside a collider, in its own frame.
Vec3 inner_point(const ColliderGeometry& geometry) {
    // the middle of a bucket is empty; the middle of its floor is not
    if (geometry.shape == ColliderShape::bucket) return {0, 0, -geometry.size[2] / 2};
    return Vec3::Zero();
}

/// From a point to the nearest of a surface, m.
Vec3 to_surface(const Solid& solid, const Vec3& point) {
    Real least = std::numeric_limits<Real>::infinity();
    Vec3 way = Vec3::Zero();
    for (const SolidTriangle& t : solid.surface) {
        const auto at = [&](std::size_t k) -> const Vec3& { return solid.point[static_cast<std::size_t>(t.node[k])]; };
        const PointTriangle found = closest_point_on_triangle(point, at(0), at(1), at(2));
        if (found.distance_squared < least) {
            least = found.distance_squared;
            way = found.nearest - point;
        }
    }
    return way;
}

}  // namespace

std::optional<Overlap> find_points_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                          const PlacedSolid& body, Real tolerance) {
    Overlap overlap{OverlapKind::crossing, 0, Vec3::UnitZ(), Vec3::Zero()};
    Aabb inside = empty_box();
    std::size_t count = 0;
    for (const Index n : body.solid.surface_point) {
        const Vec3 x = body.solid.point[static_cast<std::size_t>(n)] + body.shift;
        const SurfacePoint found = distance_to_collider(geometry, motion, x);
        if (!(found.distance < -tolerance)) continue;
        ++count;
        grow(inside, x);
        if (-found.distance > overlap.depth) {
            overlap.depth = -found.distance;
            overlap.direction = found.normal;
        }
    }
    if (count == 0) return std::nullopt;
    if (count == body.solid.surface_point.size()) overlap.kind = OverlapKind::inside;
    overlap.place = (inside.lower + inside.upper) / 2;
    return overlap;
}

std::optional<Overlap> find_collider_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                            const PlacedSolid& body) {
    const Vec3 point = motion.position + motion.rotation * inner_point(geometry);
    if (!contains(body.solid, point - body.shift, 0)) return std::nullopt;
    Vec3 way = to_surface(body.solid, point - body.shift);
    const Real length = way.norm();
    // The body goes against the way out of the collider, and past its other side.
    return Overlap{OverlapKind::around, length + collider_radius(geometry),
                   length > 0 ? Vec3(-way / length) : Vec3(Vec3::UnitZ()), point};
}

}  // namespace skerry
