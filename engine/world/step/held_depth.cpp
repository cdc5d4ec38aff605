// Measures how deep held nodes (nodes whose motion is prescribed) are inside other objects. The contact table does not
// contain contacts between nodes that no impulse can move, so measure_contacts does not see these overlaps.
#include <Eigen/Geometry>
#include <algorithm>

#include "engine/world/query/fitted_tree.h"
#include "engine/world/step/step.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/collision/narrow/winding_number.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

namespace {

bool is_held(const Model& model, Index node) {
    return !(model.nodes.inverse_mass[static_cast<std::size_t>(node)] > 0);
}

bool has_held_nodes(const Model& model, Index body) {
    return model.bodies.pinned_count[static_cast<std::size_t>(body)] > 0;
}

/// True if an attachment moves nodes of the body in this step.
bool is_led(const Model& model, Index body) {
    for (std::size_t a = 0; a < model.attachments.slot.size(); ++a)
        if (model.attachments.body[a] == body && !model.attachments.motion[a].stands_still()) return true;
    return false;
}

/// Calls visit(node) for each held node on the surface of a body, with the row of the node in NodeTable. `body`: row of
/// BodyTable.
void for_each_held(const Model& model, Index body, auto&& visit) {
    const Range vertices = model.bodies.vertices[static_cast<std::size_t>(body)];
    for (Index v = vertices.begin; v < vertices.end; ++v)
        if (const Index node = model.surface.vertices.node[static_cast<std::size_t>(v)]; is_held(model, node))
            visit(node);
}

/// True if a point is in front of its nearest triangle, and its nearest point on this triangle is not on an edge.
bool is_in_front(const Model& model, const TrianglePoint& nearest, const Vec3& point) {
    const auto& [a, b, c] = model.surface.triangles.node[static_cast<std::size_t>(nearest.triangle)];
    const auto at = [&](Index n) -> const Vec3& { return model.nodes.position[static_cast<std::size_t>(n)]; };
    const bool over_face = std::ranges::all_of(nearest.weight, [](Real weight) { return weight > 0; });
    return over_face && (at(b) - at(a)).cross(at(c) - at(a)).dot(point - at(a)) > 0;
}

/// Updates `deepest` with held nodes of `body` inside `other`. A node counts only if its nearest triangle has three
/// held nodes, because contacts can move all other triangles. `pair`: ContactKey::pair of the two objects.
void add_nodes_inside(WorldState& world, Index body, Index other, std::uint64_t pair, HeldDepth& deepest) {
    const Model& model = world.model;
    const SurfaceTree tree = fitted_tree(world, static_cast<std::size_t>(other));
    if (tree.tree.size() == 0) return;
    const CollisionInputs inputs =
        CollisionInputs::bind({}, model.bodies, model.colliders, model.surface, model.materials, model.bvh,
                              model.bvh_leaves, model.nodes, model.disabled_pairs, model.material_pairs);
    for_each_held(model, body, [&](Index node) {
        const Vec3& point = model.nodes.position[static_cast<std::size_t>(node)];
        const std::optional<TrianglePoint> found = nearest_point(tree, point, infinity);
        if (!found || !(found->distance > deepest.depth)) return;
        const auto& [a, b, c] = model.surface.triangles.node[static_cast<std::size_t>(found->triangle)];
        if (!is_held(model, a) || !is_held(model, b) || !is_held(model, c)) return;
        // is_outside computes the winding number, which is slow, so is_in_front is tried first
        if (is_in_front(model, *found, point) || is_outside(inputs, other, point)) return;
        deepest.take({found->distance, pair});
    });
}

}  // namespace

HeldDepth held_in_shapes(const WorldState& world, bool all) {
    const Model& model = world.model;
    const PairTable& pairs = world.cache.pairs;
    HeldDepth deepest;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (pairs.kind[p] != PairKind::collider || !has_held_nodes(model, pairs.first[p])) continue;
        const auto c = static_cast<std::size_t>(pairs.second[p]);
        if (!all && model.colliders.motion[c].stands_still() && !is_led(model, pairs.first[p])) continue;
        const RigidPose pose =
            pose_at(model.colliders.script[c], model.colliders.keyframe, model.colliders.initial[c], world.clock.time);
        const RigidMotion now{pose.position, pose.rotation, Vec3::Zero(), Vec3::Zero()};
        for_each_held(model, pairs.first[p], [&](Index node) {
            const Vec3& point = model.nodes.position[static_cast<std::size_t>(node)];
            deepest.take({-distance_to_collider(model.colliders.geometry[c], now, point).distance, pairs.key[p]});
        });
    }
    return deepest;
}

HeldDepth held_in_surfaces(WorldState& world) {
    const Model& model = world.model;
    const PairTable& pairs = world.cache.pairs;
    HeldDepth deepest;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const Index first = pairs.first[p], second = pairs.second[p];
        if (pairs.kind[p] != PairKind::bodies || !has_held_nodes(model, first) || !has_held_nodes(model, second))
            continue;
        add_nodes_inside(world, first, second, pairs.key[p], deepest);
        add_nodes_inside(world, second, first, pairs.key[p], deepest);
    }
    return deepest;
}

}  // namespace skerry
