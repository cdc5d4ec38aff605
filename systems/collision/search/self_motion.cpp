#include "systems/collision/search/self_motion.h"

#include <algorithm>
#include <cmath>

#include "systems/collision/tree/bvh.h"
#include "systems/collision/tree/leaf_pairs.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Computes the boxes of the tree of a body for a value of each node, for example a displacement.
void fit(const CollisionInputs& inputs, Index body, std::span<const Vec3> of_node, Column<Aabb>& box) {
    refit_bvh(inputs.body.bvh_nodes[body], inputs.bvh_node, inputs.leaf_nodes, of_node, box);
}

/// Calls visit(n) for each node n on the surface of a body.
void for_each_node(const CollisionInputs& inputs, Index body, auto&& visit) {
    const Range vertices = inputs.body.vertices[body];
    for (Index v = vertices.begin; v < vertices.end; ++v) visit(inputs.surface.vertices.node[v]);
}

/// The rigid motion of a body since the last search: a point X moves to now + rotation (X - before).
struct RigidDisplacement {
    Vec3 before = Vec3::Zero(), now = Vec3::Zero();  // centres [m]
    Mat3 rotation = Mat3::Identity();
};

/// Computes the rigid motion that is nearest to the displacements u of the surface nodes if the rotation is small. The
/// rotation vector minimises the sum of |w x r - u|^2.
RigidDisplacement rigid_displacement(const CollisionInputs& inputs, Index body, const SelfSearch& self,
                                     auto&& position) {
    RigidDisplacement part;
    for_each_node(inputs, body, [&](Index n) {
        part.before += self.origin[n];
        part.now += position(n);
    });
    const Real count = inputs.body.vertices[body].size();
    part.before /= count;
    part.now /= count;
    Mat3 inertia = Mat3::Zero();
    Vec3 moment = Vec3::Zero();
    for_each_node(inputs, body, [&](Index n) {
        const Vec3 r = self.origin[n] - part.before;
        inertia.diagonal().array() += r.squaredNorm();
        inertia -= r * r.transpose();
        moment += r.cross(position(n) - part.now);
    });
    const Vec3 turn = inertia.inverse() * moment;
    if (turn.allFinite()) part.rotation = rotation_matrix(turn);
    return part;
}

/// Computes the boxes of the motion since the last search. position(n): position of node n [m].
void fit_motion(const CollisionInputs& inputs, Index body, SelfSearch& self, auto&& position) {
    const RigidDisplacement part = rigid_displacement(inputs, body, self, position);
    for_each_node(inputs, body, [&](Index n) {
        self.moved[n] = position(n) - part.now - part.rotation * (self.origin[n] - part.before);
    });
    fit(inputs, body, self.origin, self.origin_box);
    fit(inputs, body, self.origin_step, self.origin_step_box);
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
    // Rows of nodes inside bodies are not used, but they are saved.
    for (Column<Vec3>* column : {&self.origin, &self.origin_step, &self.moved})
        column->resize(inputs.position.size(), Vec3::Zero());
    for (Column<Aabb>* box : {&self.origin_box, &self.origin_step_box, &self.moved_box, &self.speed_box})
        box->resize(inputs.bvh_node.size());
}

void store_origin(const SelfMotion& motion, SelfSearch& self) {
    const CollisionInputs& inputs = motion.inputs;
    for_each_node(inputs, motion.body, [&](Index n) {
        self.origin[n] = inputs.position[n];
        self.origin_step[n] = motion.h * inputs.velocity[n];
    });
    fit(inputs, motion.body, self.origin_step, self.origin_step_box);
    fit(inputs, motion.body, inputs.velocity, self.speed_box);
}

Real spare_margin_of(const SelfMotion& motion, Real least, SelfSearch& self) {
    const CollisionInputs& inputs = motion.inputs;
    fit_motion(inputs, motion.body, self, [&](Index n) -> const Vec3& { return inputs.position[n]; });
    Real spare = motion.skin;
    any_part(
        motion,
        [&](Index a, Index b) {
            const Real moved = farthest(self.moved_box[a], self.moved_box[b]);
            return !(motion.skin - moved >= spare) && were_near(self, a, b, motion.scale.zone + moved + spare);
        },
        [&](Index a, Index b) {
            const Real moved = farthest(self.moved_box[a], self.moved_box[b]),
                       apart = std::sqrt(distance_squared(self.origin_box[a], self.origin_box[b]));
            spare = std::min(spare, std::max(motion.margin_of(self, a, b), apart - motion.scale.zone) - moved);
            return !(spare > least);
        });
    return spare;
}

bool holds_for_step(const SelfMotion& motion, SelfSearch& self) {
    fit(motion.inputs, motion.body, motion.inputs.velocity, self.speed_box);
    const auto closing = [&](Index a, Index b) {
        return farthest(self.moved_box[a], self.moved_box[b]) + motion.reach_of(self, a, b);
    };
    return !any_part(
        motion,
        [&](Index a, Index b) {
            const Real closed = closing(a, b);
            return !(closed < motion.skin) && were_near(self, a, b, motion.scale.zone + closed);
        },
        [&](Index a, Index b) { return !(closing(a, b) < motion.margin_of(self, a, b)); });
}

bool holds_for_motion(const SelfMotion& motion, const StepMotion& step, bool fresh, SelfSearch& self) {
    const CollisionInputs& inputs = motion.inputs;
    fit_motion(inputs, motion.body, self, [&](Index n) { return Vec3(inputs.position[n] + step.of(n)); });
    return !any_part(
        motion,
        [&](Index a, Index b) {
            const Real closed = farthest(self.moved_box[a], self.moved_box[b]);
            return !(closed < motion.skin) && were_near(self, a, b, closed);
        },
        [&](Index a, Index b) {
            const Real margin = motion.margin_of(self, a, b),
                       listed = fresh ? std::max(margin, motion.reach_of(self, a, b)) : margin;
            return !(farthest(self.moved_box[a], self.moved_box[b]) < listed);
        });
}

}  // namespace skerry
