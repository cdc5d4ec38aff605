// Read access to the state of single bodies and colliders.
#include <Eigen/Dense>

#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/world_state.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/dynamics/rigid/rigid_motion.h"
#include "systems/geometry/rotation.h"

namespace skerry {

std::span<const Vec3> World::positions(BodyHandle body) const {
    state_->settle();
    return rows_of(state_->model.nodes.position,
                   state_->model.bodies.nodes[static_cast<std::size_t>(state_->model.row(body, "positions"))]);
}

std::span<const Vec3> World::velocities(BodyHandle body) const {
    state_->settle();
    return rows_of(state_->model.nodes.velocity,
                   state_->model.bodies.nodes[static_cast<std::size_t>(state_->model.row(body, "velocities"))]);
}

std::span<const std::array<Index, 3>> World::surface(BodyHandle body) const {
    state_->settle();
    return state_->model.body_records[static_cast<std::size_t>(state_->model.row(body, "surface"))].surface;
}

std::span<const std::array<Index, 4>> World::tetrahedra(BodyHandle body) const {
    state_->settle();
    return state_->model.body_records[static_cast<std::size_t>(state_->model.row(body, "tetrahedra"))].tetrahedra;
}

const std::string& World::name(BodyHandle body) const {
    state_->settle();
    return state_->model.body_records[static_cast<std::size_t>(state_->model.row(body, "name"))].name;
}

ElementKind World::element(BodyHandle body) const {
    return state_->model.body_records[static_cast<std::size_t>(state_->model.row(body, "element"))].element;
}

Real World::mass(BodyHandle body) const {
    Real sum = 0;
    for (Real m : rows_of(state_->model.nodes.mass,
                          state_->model.bodies.nodes[static_cast<std::size_t>(state_->model.row(body, "mass"))]))
        sum += m;
    return sum;
}

Vec3 World::center_of_mass(BodyHandle body) const {
    state_->settle();
    const Range nodes = state_->model.bodies.nodes[static_cast<std::size_t>(state_->model.row(body, "center_of_mass"))];
    Vec3 moment = Vec3::Zero();
    Real mass = 0;
    for (auto n = static_cast<std::size_t>(nodes.begin); n < static_cast<std::size_t>(nodes.end); ++n) {
        moment += state_->model.nodes.mass[n] * state_->model.nodes.position[n];
        mass += state_->model.nodes.mass[n];
    }
    return moment / mass;
}

Real World::contact_distance(BodyHandle body) const {
    return state_->model.bodies.contact_distance[static_cast<std::size_t>(state_->model.row(body, "contact_distance"))];
}

Real World::mean_edge(BodyHandle body) const {
    return state_->model.bodies.mean_edge[static_cast<std::size_t>(state_->model.row(body, "mean_edge"))];
}

bool World::asleep(BodyHandle body) const {
    state_->settle();
    return state_->model.bodies.asleep[static_cast<std::size_t>(state_->model.row(body, "asleep"))] != 0;
}

void World::wake(BodyHandle body) {
    state_->require_between_steps("wake");
    state_->model.wake(static_cast<std::size_t>(state_->model.row(body, "wake")));
}

std::vector<BodyHandle> World::bodies() const {
    state_->settle();
    std::vector<BodyHandle> handles;
    for (std::size_t b = 0; b < state_->model.bodies.slot.size(); ++b)
        if (state_->model.bodies.kind[b] == BodyKind::deformable)
            handles.push_back(state_->model.body_map.handle_of_slot(state_->model.bodies.slot[b]));
    return handles;
}

std::vector<ColliderHandle> World::colliders() const {
    state_->settle();
    std::vector<ColliderHandle> handles;
    for (std::uint32_t slot : state_->model.colliders.slot)
        handles.push_back(state_->model.collider_map.handle_of_slot(slot));
    return handles;
}

Twist World::velocity(BodyHandle body) const {
    state_->settle();
    const auto row = static_cast<std::size_t>(state_->model.row(body, "velocity"));
    if (state_->model.is_rigid(row)) {
        const RigidBodyTable& table = state_->model.rigid_bodies;
        const auto r = static_cast<std::size_t>(state_->model.bodies.rigid[row].begin);
        return {table.momentum[r] / table.mass[r],
                spin_of(table.rotation[r], table.moments[r], table.angular_momentum[r])};
    }
    const NodeMotion motion = motion_of_nodes(state_->model, row, center_of_mass(body));
    return {motion.momentum / mass(body), motion.inertia.inverse() * motion.angular_momentum};
}

Twist World::velocity(ColliderHandle collider) const {
    const auto row = static_cast<std::size_t>(state_->model.row(collider, "velocity"));
    const RigidMotion& motion = state_->model.colliders.motion[row];
    return {motion.velocity, motion.angular_velocity};
}

Twist World::velocity(AttachmentHandle attachment) const {
    const auto row = static_cast<std::size_t>(state_->model.row(attachment, "velocity"));
    const RigidMotion& motion = state_->model.attachments.motion[row];
    return {motion.velocity, motion.angular_velocity};
}

MotionKey World::pose(BodyHandle body) const {
    state_->settle();
    const RigidPose pose = pose_of_body(state_->model, static_cast<std::size_t>(state_->model.row(body, "pose")));
    return {time(), pose.position, rotation_vector(pose.rotation)};
}

DynamicsEstimate World::dynamics_choice(BodyHandle body) const {
    return state_->model.body_records[static_cast<std::size_t>(state_->model.row(body, "dynamics_choice"))].choice;
}

BodyDynamics World::dynamics(BodyHandle body) const {
    const auto row = static_cast<std::size_t>(state_->model.row(body, "dynamics"));
    return state_->model.dynamics_of(row);
}

MotionKey World::pose(ColliderHandle collider) const {
    const auto row = static_cast<std::size_t>(state_->model.row(collider, "pose"));
    const RigidPose pose = pose_at(state_->model.colliders.script[row], state_->model.colliders.keyframe,
                                   state_->model.colliders.initial[row], time());
    return {time(), pose.position, rotation_vector(pose.rotation)};
}

const Shape& World::shape(ColliderHandle collider) const {
    state_->settle();
    return state_->model.collider_records[static_cast<std::size_t>(state_->model.row(collider, "shape"))].shape;
}

const std::string& World::name(ColliderHandle collider) const {
    state_->settle();
    return state_->model.collider_records[static_cast<std::size_t>(state_->model.row(collider, "name"))].name;
}

}  // namespace skerry
