#include "systems/collision/search/self_motion.h"

#include <algorithm>
#include <cmath>

#include "systems/collision/tree/bvh.h"
#include "systems/collision/tree/leaf_pairs.h"

namespace skerry {

namespace {

/// Computes the boxes of the tree of a body for a value of each node, for example a displacement.
void fit(const CollisionInputs& inputs, Index body, std::span<const Vec3> of_node, Column<Aabb>& box) {
    refit_bvh(inputs.body.bvh_nodes[body], inputs.bvh_node, inputs.leaf_nodes, of_node, box);
}

/// Stores value(n) for each node n on the surface of a body.
void for_each_node(const CollisionInputs& inputs, Index body, Column<Vec3>& of_node, auto&& value) {
    const Range vertices = inputs.body.vertices[body];
    for (Index v = vertices.begin; v < vertices.end; ++v) {
        const Index n = inputs.surface.vertices.node[v];
        of_node[n] = value(n);
    }
}

/// Computes the boxes of the motion since the last search. moved(n): displacement of node n [m].
void fit_motion(const CollisionInputs& inputs, Index body, SelfSearch& self, auto&& moved) {
    for_each_node(inputs, body, self.moved, moved);
    fit(inputs, body, self.origin, self.origin_box);
    fit(inputs, body, self.moved, self.moved_box);
}

/// True if two parts of the tree were at most `distance` apart at the last search [m].
bool were_near(const SelfSearch& self, Index a, Index b, Real distance) {
    return !(distance_squared(self.origin_box[a], self.origin_box[b]) > distance * distance);
}

bool any_part(const SelfMotion& motion, const auto& near, const auto& visit) {
    const Index root = motion.inputs.body.bvh_nodes[motion.body].begin;
    return any_leaf_pair(motion.inputs.bvh_node, root, root, true, near, visit);
}

}  // namespace

void resize(const CollisionInputs& inputs, SelfSearch& self) {
    self.origin.resize(inputs.position.size());
    self.moved.resize(inputs.position.size());
    for (Column<Aabb>* box : {&self.origin_box, &self.moved_box, &self.speed_box}) box->resize(inputs.bvh_node.size());
}

void fit_speeds(const CollisionInputs& inputs, Index body, SelfSearch& self) {
    fit(inputs, body, inputs.velocity, self.speed_box);
}

void store_origin(const CollisionInputs& inputs, Index body, SelfSearch& self) {
    for_each_node(inputs, body, self.origin, [&](Index n) { return inputs.position[n]; });
}

bool holds_for_step(const SelfMotion& motion, SelfSearch& self) {
    const CollisionInputs& inputs = motion.inputs;
    fit_motion(inputs, motion.body, self, [&](Index n) { return Vec3(inputs.position[n] - self.origin[n]); });
    fit_speeds(inputs, motion.body, self);
    return !any_part(
        motion,
        [&](Index a, Index b) {
            const Real closing = farthest(self.moved_box[a], self.moved_box[b]) + motion.reach_of(self, a, b);
            return !(closing < motion.skin) && were_near(self, a, b, motion.scale.zone + closing);
        },
        [](Index, Index) { return true; });
}

bool holds_for_motion(const SelfMotion& motion, const StepMotion& step, bool fresh, SelfSearch& self) {
    const CollisionInputs& inputs = motion.inputs;
    fit_motion(inputs, motion.body, self,
               [&](Index n) { return Vec3(inputs.position[n] + step.of(n) - self.origin[n]); });
    return !any_part(
        motion,
        [&](Index a, Index b) {
            const Real closing = farthest(self.moved_box[a], self.moved_box[b]);
            return !(closing < motion.skin) && were_near(self, a, b, closing);
        },
        [&](Index a, Index b) {
            return !fresh ||
                   !(farthest(self.moved_box[a], self.moved_box[b]) < motion.skin + motion.reach_of(self, a, b));
        });
}

}  // namespace skerry
