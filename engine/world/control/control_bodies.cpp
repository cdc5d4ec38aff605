// Positions, velocities and loads of the nodes of a body.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/world/control/control.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

std::string title_of_body(const Model& model, std::size_t body) {
    return "body '" + model.body_records[body].name + "'";
}

void require_values(const Model& model, std::size_t body, const char* call, const char* field,
                    std::span<const Vec3> values) {
    const auto count = static_cast<std::size_t>(model.bodies.nodes[body].size());
    if (values.size() != count)
        refuse(call, field, std::to_string(values.size()) + " values",
               std::to_string(count) + ", one for each node of " + title_of_body(model, body));
    for (std::size_t n = 0; n < values.size(); ++n)
        if (!values[n].allFinite())
            refuse(call, field, "a value that is not finite at node " + std::to_string(n), "finite numbers");
}

Real volume_sign(const std::array<Index, 4>& corner, std::span<const Vec3> position) {
    const auto at = [&](std::size_t k) -> const Vec3& { return position[static_cast<std::size_t>(corner[k])]; };
    Mat3 edges;
    edges << at(1) - at(0), at(2) - at(0), at(3) - at(0);
    return edges.determinant();
}

/// Moves a rigid body to the given node positions. Throws SceneError if no rigid motion of the body leads to these
/// positions.
void place_rigid(WorldState& world, std::size_t body, std::span<const Vec3> position) {
    Model& model = world.model;
    const RigidFit fit = fit_rigid_body(model, body, position);
    // upper limit on the distance of a node from the rigid shape, divided by the mean edge length; allows for rounding
    // errors
    constexpr Real rounding = 1e-6;
    if (fit.misfit > rounding * model.bodies.mean_edge[body])
        refuse(title_of_body(model, body), "position",
               "node positions that differ by " + shown(fit.misfit) + " m from the rigid shape",
               "the shape of the rigid body, translated and rotated as a whole");
    place_nodes(world, body, position);
    set_rigid_pose(model, body, fit.center, fit.rotation);
}

}  // namespace

void require_upright(const Model& model, std::size_t body, std::span<const Vec3> position, const std::string& object,
                     const char* field) {
    const Range nodes = model.bodies.nodes[body];
    const std::span<const Vec3> now = model.nodes.position.span().subspan(static_cast<std::size_t>(nodes.begin),
                                                                          static_cast<std::size_t>(nodes.size()));
    const std::vector<std::array<Index, 4>>& tetrahedra = model.body_records[body].tetrahedra;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        if (!(volume_sign(tetrahedra[t], position) > 0) && volume_sign(tetrahedra[t], now) > 0)
            refuse(object, field, "positions for which tetrahedron " + std::to_string(t) + " has a volume <= 0",
                   "positions that invert no tetrahedron");
}

void hold_here(Model& model, std::size_t body, Real now) {
    AttachmentTable& table = model.attachments;
    for (std::size_t a = 0; a < table.slot.size(); ++a) {
        if (table.body[a] != static_cast<Index>(body)) continue;
        const RigidPose pose = pose_at(table.script[a], table.keyframe, table.initial[a], now);
        for (Index i = table.nodes[a].begin; i < table.nodes[a].end; ++i) {
            const auto at = static_cast<std::size_t>(i);
            table.anchor[at] = pose.rotation.transpose() *
                               (model.nodes.position[static_cast<std::size_t>(table.node[at])] - pose.position);
        }
    }
}

void place_nodes(WorldState& world, std::size_t body, std::span<const Vec3> position) {
    Model& model = world.model;
    // wakes bodies that rest on the body at its old position and may lose their support
    world.edits.places.add_body(model, body);
    const std::span<Vec3> target = rows_of(model.nodes.position, model.bodies.nodes[body]);
    const std::span<Vec3> origin = rows_of(model.nodes.displacement_origin, model.bodies.nodes[body]);
    for (std::size_t n = 0; n < position.size(); ++n) {
        // The point from which BodyTable::displacement is measured moves by as much as the node, so the displacement
        // does not change.
        origin[n] += position[n] - target[n];
        target[n] = position[n];
    }
    renew_corners(model, body);
    yield_blocks(world, model.all_elements(), model.bodies.blocks[body]);
    if (model.bodies.blocks[body].size() > 0)
        model.bodies.stable_step[body] =
            evaluate_stable_step(model, body, model.nodes.position, world.scratch.stiffness_sum);
    model.watch.forget(body);
    model.body_records[body].settled = model.settled = false;
    world.query_trees.forget();
    world.cache.forget_body(model, body);
    world.record.balance.close();
    model.wake(body);
    world.edits.places.add_body(model, body);  // at its new position the body may touch other bodies
}

void World::set_positions(BodyHandle body, std::span<const Vec3> position) {
    state_->require_between_steps("set_positions");
    Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "set_positions"));
    require_values(model, row, "set_positions", "position", position);
    if (std::ranges::equal(position, rows_of(model.nodes.position, model.bodies.nodes[row]))) return;
    if (model.is_rigid(row)) {
        place_rigid(*state_, row, position);
        hold_here(model, row, time());
        find_holding_attachments(model);
        return;
    }
    require_upright(model, row, position, title_of_body(model, row), "position");
    place_nodes(*state_, row, position);
    const bool held = model.is_held(row);
    if (model.has_frame(row) && !held) {
        set_deformed_shape(model, row, position);
        return;
    }
    hold_here(model, row, time());
    if (!held) return;
    find_holding_attachments(model);
    follow_attachments(model, row);
}

void World::set_velocities(BodyHandle body, std::span<const Vec3> velocity) {
    state_->require_between_steps("set_velocities");
    Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "set_velocities"));
    require_values(model, row, "set_velocities", "velocity", velocity);
    const Range nodes = model.bodies.nodes[row];
    const std::span<Vec3> target = rows_of(model.nodes.velocity, nodes);
    bool changed = false;
    for (std::size_t n = 0; n < velocity.size(); ++n) {
        // Held nodes keep the velocities that their attachments prescribe.
        const bool free = model.nodes.inverse_mass[static_cast<std::size_t>(nodes.begin) + n] > 0;
        if (!free || target[n] == velocity[n]) continue;
        target[n] = velocity[n];
        changed = true;
    }
    if (!changed) return;
    if (model.has_frame(row)) follow_node_velocities(model, row);
    // all contact pairs of the body must be searched again, because the last search assumed the old speeds
    state_->cache.forget_body(model, row);
    state_->record.balance.close();
    model.wake(row);
}

void World::set_pose(BodyHandle body, const Pose& pose) {
    state_->require_between_steps("set_pose");
    state_->settle();
    const Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "set_pose"));
    if (!pose.position.allFinite() || !pose.rotation.allFinite()) validate(pose, title_of_body(model, row));
    const RigidPose from = pose_of_body(model, row);
    if (from.position == pose.position && rotation_vector(from.rotation) == pose.rotation) return;
    const Mat3 turn = rotation_matrix(pose.rotation) * from.rotation.transpose();
    const auto now = positions(body);
    std::vector<Vec3> position(now.begin(), now.end());
    for (Vec3& x : position) x = pose.position + turn * (x - from.position);
    set_positions(body, position);
}

void World::set_velocity(BodyHandle body, const Vec3& velocity, const Vec3& angular_velocity) {
    state_->require_between_steps("set_velocity");
    state_->settle();
    const auto row = static_cast<std::size_t>(state_->model.row(body, "set_velocity"));
    require_finite(title_of_body(state_->model, row), "velocity", velocity);
    require_finite(title_of_body(state_->model, row), "angular_velocity", angular_velocity);
    const Vec3 center = center_of_mass(body);
    std::vector<Vec3> of_nodes;
    for (const Vec3& x : positions(body)) of_nodes.push_back(velocity + angular_velocity.cross(x - center));
    set_velocities(body, of_nodes);
}

std::span<const Vec3> World::loads(BodyHandle body) const {
    state_->settle();
    return rows_of(state_->model.nodes.load,
                   state_->model.bodies.nodes[static_cast<std::size_t>(state_->model.row(body, "loads"))]);
}

void World::set_loads(BodyHandle body, std::span<const Vec3> load) {
    state_->require_between_steps("set_loads");
    Model& model = state_->model;
    const auto row = static_cast<std::size_t>(model.row(body, "set_loads"));
    require_values(model, row, "set_loads", "load", load);
    const std::span<Vec3> target = rows_of(model.nodes.load, model.bodies.nodes[row]);
    if (std::ranges::equal(load, target)) return;
    const bool before = model.has_loads(row);
    std::ranges::copy(load, target.begin());
    model.note_loads(row, before);
    note_forces(model);
    model.wake(row);
}

}  // namespace skerry
