// Ray casts and nearest points: searches of all surfaces for the nearest hit.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/world/query/fitted_tree.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/query/collider_ray.h"
#include "systems/collision/query/surface_query.h"
#include "systems/collision/tree/bvh.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

namespace {

template <class T>
bool has(const std::vector<T>& list, const T& item) {
    return std::ranges::find(list, item) != list.end();
}

}  // namespace

SurfaceTree fitted_tree(WorldState& world, std::size_t body) {
    const Model& model = world.model;
    QueryTrees& trees = world.query_trees;
    if (trees.fitted.size() != model.bodies.slot.size()) {
        trees.box.resize(model.bvh.node.size());
        trees.fitted.assign(model.bodies.slot.size(), 0);
    }
    const Range tree = model.bodies.bvh_nodes[body];
    if (!trees.fitted[body] && tree.size() > 0)
        refit_bvh(tree, model.bvh.node, model.bvh_leaves.nodes, model.nodes.position, trees.box.span());
    trees.fitted[body] = 1;
    return {
        tree, model.bvh.node, model.bvh_leaves.triangle, trees.box, model.surface.triangles.node, model.nodes.position};
}

namespace {

SurfaceHit hit_of(const Model& model, const TrianglePoint& found, std::size_t body) {
    SurfaceHit hit;
    const auto& [a, b, c] = model.surface.triangles.node[static_cast<std::size_t>(found.triangle)];
    const auto at = [&](Index n) -> const Vec3& { return model.nodes.position[static_cast<std::size_t>(n)]; };
    hit.triangle = found.triangle - model.bodies.triangles[body].begin;
    hit.barycentric = found.weight;
    hit.point = found.weight[0] * at(a) + found.weight[1] * at(b) + found.weight[2] * at(c);
    hit.normal = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
    hit.distance = found.distance;
    return hit;
}

/// Returns the nearest hit on all surfaces that the filter admits. Of equally near hits the first one counts: bodies
/// are searched before colliders, both in the order of their rows.
/// - `limit`: largest distance of a hit [m]. Each hit reduces it to the distance of this hit.
/// - of_tree(), of_shape(): return the nearest hit on a surface of triangles, and on an analytic shape, up to the
///   distance in their argument `limit`.
std::optional<SurfaceHit> first_of(WorldState& world, const QueryFilter& filter, Real limit, auto&& of_tree,
                                   auto&& of_shape) {
    world.settle();
    const Model& model = world.model;
    std::optional<SurfaceHit> best;
    const auto take = [&](SurfaceHit hit, BodyHandle body, ColliderHandle collider) {
        if (best && !(hit.distance < best->distance)) return;
        hit.body = body;
        hit.collider = collider;
        limit = hit.distance;
        best = hit;
    };
    for (std::size_t b = 0; filter.bodies && b < model.bodies.slot.size(); ++b) {
        if (model.bodies.kind[b] != BodyKind::deformable || !(model.bodies.filter[b].group & filter.groups)) continue;
        const BodyHandle handle = model.body_map.handle_of_slot(model.bodies.slot[b]);
        if (has(filter.except_bodies, handle)) continue;
        if (const auto round = model.round_shape(b)) {
            if (const std::optional<SurfaceHit> found = of_shape(round->geometry, round->motion, limit))
                take(*found, handle, {});
            continue;
        }
        if (const std::optional<TrianglePoint> found = of_tree(fitted_tree(world, b), limit))
            take(hit_of(model, *found, b), handle, {});
    }
    for (std::size_t c = 0; filter.colliders && c < model.colliders.slot.size(); ++c) {
        const ColliderHandle handle = model.collider_map.handle_of_slot(model.colliders.slot[c]);
        if (!(model.colliders.filter[c].group & filter.groups) || has(filter.except_colliders, handle)) continue;
        if (const Index mesh = model.colliders.body[c]; mesh != no_index) {
            const auto b = static_cast<std::size_t>(mesh);
            if (const std::optional<TrianglePoint> found = of_tree(fitted_tree(world, b), limit))
                take(hit_of(model, *found, b), {}, handle);
            continue;
        }
        const RigidPose pose =
            pose_at(model.colliders.script[c], model.colliders.keyframe, model.colliders.initial[c], world.clock.time);
        if (const std::optional<SurfaceHit> found =
                of_shape(model.colliders.geometry[c],
                         RigidMotion{pose.position, pose.rotation, Vec3::Zero(), Vec3::Zero()}, limit))
            take(*found, {}, handle);
    }
    return best;
}

void require_distance(const char* call, Real max_distance) {
    if (max_distance >= 0) return;
    refuse(call, "max_distance", std::to_string(max_distance), "a length >= 0, or infinity (m)");
}

}  // namespace

std::optional<SurfaceHit> World::cast_ray(const Vec3& origin, const Vec3& direction, Real max_distance,
                                          const QueryFilter& filter) const {
    require_finite("cast_ray", "origin", origin);
    require_finite("cast_ray", "direction", direction);
    require_distance("cast_ray", max_distance);
    const Real length = direction.stableNorm();
    if (!(length > 0) || !std::isfinite(length))
        refuse("cast_ray", "direction", "a length of " + std::to_string(length), "a finite vector that is not zero");
    const Ray ray{origin, direction / length};
    return first_of(
        *state_, filter, max_distance,
        [&](const SurfaceTree& tree, Real limit) { return skerry::cast_ray(tree, ray, limit); },
        [&](const ColliderGeometry& geometry, const RigidMotion& pose, Real limit) {
            std::optional<SurfaceHit> hit;
            if (const std::optional<ShapePoint> found = skerry::cast_ray(geometry, pose, ray, limit)) {
                hit.emplace();
                hit->point = ray.origin + found->distance * ray.direction;
                hit->normal = found->normal;
                hit->distance = found->distance;
            }
            return hit;
        });
}

std::optional<SurfaceHit> World::nearest_point(const Vec3& point, Real max_distance, const QueryFilter& filter) const {
    require_finite("nearest_point", "point", point);
    require_distance("nearest_point", max_distance);
    return first_of(
        *state_, filter, max_distance,
        [&](const SurfaceTree& tree, Real limit) { return skerry::nearest_point(tree, point, limit); },
        [&](const ColliderGeometry& geometry, const RigidMotion& pose, Real limit) {
            const SurfacePoint found = distance_to_collider(geometry, pose, point);
            std::optional<SurfaceHit> hit;
            if (!(std::abs(found.distance) <= limit)) return hit;
            hit.emplace();
            hit->point = found.point;
            hit->normal = found.normal;
            hit->distance = std::abs(found.distance);
            return hit;
        });
}

}  // namespace skerry
