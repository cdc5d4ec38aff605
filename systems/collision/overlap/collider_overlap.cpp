#include "systems/collision/overlap/collider_overlap.h"

#include <algorithm>

#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/colliders/edge_contact.h"
#include "systems/collision/colliders/time_of_touch.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/narrow/rigid_frame.h"
#include "systems/collision/tree/box.h"
#include "systems/geometry/closest_points.h"

namespace skerry {

namespace {

/// Returns a point inside a collider, in the coordinate frame of the collider.
Vec3 inner_point(const ColliderGeometry& geometry) {
    // The centre of a bucket is empty, but the centre of its floor is solid.
    if (geometry.shape == ColliderShape::bucket) return {0, 0, -geometry.size[2] / 2};
    return Vec3::Zero();
}

/// Vector from a point to the nearest point on the surface of a solid [m].
Vec3 to_surface(const Solid& solid, const Vec3& point) {
    Real least = infinity;
    Vec3 offset = Vec3::Zero();
    for (const SolidTriangle& t : solid.surface) {
        const auto at = [&](std::size_t k) -> const Vec3& { return solid.point[static_cast<std::size_t>(t.node[k])]; };
        const PointTriangle found = closest_point_on_triangle(point, at(0), at(1), at(2));
        if (found.distance_squared < least) {
            least = found.distance_squared;
            offset = found.nearest - point;
        }
    }
    return offset;
}

/// A body and an analytic collider.
struct ColliderAndBody {
    const ColliderGeometry& geometry;
    const RigidMotion& motion;
    const PlacedSolid& body;

    /// Position of a node of the body in the coordinate frame of the collider.
    Vec3 local(Index node) const {
        return to_local(motion, body.solid.point[static_cast<std::size_t>(node)] + body.shift);
    }
    /// Position of a point of the collider in world coordinates.
    Vec3 world(const Vec3& point) const { return to_world(motion, point); }
};

class SurfaceInside {
public:
    SurfaceInside(const ColliderAndBody& pair, Real tolerance)
        : pair_(pair), tolerance_(tolerance), inside_(empty_box()) {}

    std::optional<Overlap> find() {
        const Solid& solid = pair_.body.solid;
        std::size_t nodes = 0;
        for (const Index n : solid.surface_point) {
            const Vec3 at = pair_.local(n);
            nodes += add(local_distance(pair_.geometry, at), at);
        }
        for (const SolidTriangle& t : solid.surface)
            for (std::size_t k = 0; k < 3; ++k)
                // Each edge of a closed surface occurs in two triangles, in opposite directions; it is tested in one of
                // them. An edge of an open surface may occur in one triangle only, so every side of every triangle is
                // tested.
                if (!solid.closed || t.node[k] < t.node[(k + 1) % 3])
                    add_edge(pair_.local(t.node[k]), pair_.local(t.node[(k + 1) % 3]));
        if (!(overlap_.depth > 0)) return std::nullopt;
        if (nodes == solid.surface_point.size()) overlap_.kind = OverlapKind::inside;
        overlap_.place = pair_.world((inside_.lower + inside_.upper) / 2);
        overlap_.direction = pair_.motion.rotation * overlap_.direction;
        return overlap_;
    }

private:
    bool add(const SurfacePoint& found, const Vec3& at) {
        if (!(found.distance < -tolerance_)) return false;
        grow(inside_, at);
        if (-found.distance > overlap_.depth) {
            overlap_.depth = -found.distance;
            overlap_.direction = found.normal;
        }
        return true;
    }
    void add_edge(const Vec3& from, const Vec3& to) {
        for (Index part = 0; part < collider_part_count(pair_.geometry.shape); ++part) {
            if (!(edge_distance(pair_.geometry, part, from, to) < -tolerance_)) continue;
            const EdgeContact contact = edge_contact(pair_.geometry, part, from, to);
            for (std::size_t i = 0; i < contact.count; ++i)
                add(contact.point[i].on, from + contact.point[i].s * (to - from));
        }
    }

    const ColliderAndBody pair_;
    const Real tolerance_;
    Aabb inside_;
    Overlap overlap_{OverlapKind::crossing, 0, Vec3::UnitZ(), Vec3::Zero()};
};

/// Finds corners, ends and rims of a collider that are inside a body.
class PointsInside {
public:
    PointsInside(const ColliderAndBody& pair, Real tolerance)
        : pair_(pair), overlap_{OverlapKind::crossing, tolerance, {}, {}} {}

    std::optional<Overlap> find() {
        for (Index k = 0; k < collider_point_count(pair_.geometry.shape); ++k) {
            if (is_moving_rim_point(pair_.geometry.shape, k))
                add_rim(k);
            else
                add(collider_point(pair_.geometry, k, Vec3::Zero()));
        }
        return found_ ? std::optional(overlap_) : std::nullopt;
    }

private:
    void add(const ColliderPoint& point) {
        const PlacedSolid& body = pair_.body;
        const Vec3 at = pair_.world(point.at) - body.shift;
        const bool within = contains(body.solid, at, 0);
        if (!within && point.radius == 0) return;
        const Vec3 offset = to_surface(body.solid, at);
        const Real length = offset.norm(), depth = (within ? length : -length) + point.radius;
        if (!(depth > overlap_.depth && length > 0)) return;
        found_ = true;
        overlap_.depth = depth;
        overlap_.direction = (within ? -offset : offset) / length;
        overlap_.place = at + body.shift;
    }
    /// Tests a rim against each face of the body. Point k, the first point of the rim, is the rim point furthest behind
    /// the plane of the face. It counts if its projection is inside the face.
    void add_rim(Index k) {
        for (const SolidTriangle& t : pair_.body.solid.surface) {
            const FaceContact face = face_contact(
                pair_.geometry, k, {pair_.local(t.node[0]), pair_.local(t.node[1]), pair_.local(t.node[2])});
            if (face.above && -face.distance > overlap_.depth) add(face.point);
        }
    }

    const ColliderAndBody pair_;
    Overlap overlap_;
    bool found_ = false;
};

}  // namespace

std::optional<Overlap> find_surface_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                           const PlacedSolid& body, Real tolerance) {
    return SurfaceInside({geometry, motion, body}, tolerance).find();
}

std::optional<Overlap> find_collider_inside(const ColliderGeometry& geometry, const RigidMotion& motion,
                                            const PlacedSolid& body, Real tolerance) {
    const Vec3 point = to_world(motion, inner_point(geometry));
    if (!contains(body.solid, point - body.shift, 0)) return PointsInside({geometry, motion, body}, tolerance).find();
    Vec3 offset = to_surface(body.solid, point - body.shift);
    const Real length = offset.norm();
    // The body moves until its surface point nearest to `point` is beyond the far side of the collider. The direction
    // of this motion is from that surface point to `point`.
    return Overlap{OverlapKind::around, length + collider_radius(geometry),
                   length > 0 ? Vec3(-offset / length) : Vec3(Vec3::UnitZ()), point};
}

std::optional<Overlap> overlap_of_round(const RoundSolid& body, const ColliderGeometry& geometry,
                                        const RigidMotion& motion, Real tolerance) {
    const std::array<Vec3, 3> core{to_local(motion, body.end[0]), to_local(motion, body.end[1]), Vec3::Zero()};
    Touch nearest{.distance = infinity, .weight = {}, .point = {}, .normal = {}};
    for (Index part = 0; part < collider_part_count(geometry.shape); ++part) {
        TouchingFeature feature{.kind = body.is_segment ? TouchingFeature::Kind::edge : TouchingFeature::Kind::node,
                                .part_or_point = part,
                                .position = core};
        feature.threshold.distance = body.radius;
        const Touch touch = nearest_touch(geometry, feature, core);
        if (touch.distance < nearest.distance) nearest = touch;
    }
    const Real depth = -nearest.distance;
    if (!(depth > tolerance)) return std::nullopt;
    const bool inside = std::ranges::all_of(
        body.end, [&](const Vec3& at) { return distance_to_collider(geometry, motion, at).distance < 0; });
    const Vec3 normal = motion.rotation * nearest.normal, point = to_world(motion, nearest.point);
    return Overlap{inside ? OverlapKind::inside : OverlapKind::crossing, depth, normal, point - depth / 2 * normal};
}

}  // namespace skerry
