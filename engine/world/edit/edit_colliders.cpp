// Functions that add colliders and attachments, and remove attachments, between steps.
#include <cmath>
#include <numbers>

#include "components/any_table.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/erase_gone.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

MotionScript append_script(const Motion& motion, Column<Keyframe>& keyframe) {
    MotionScript script{motion.velocity, motion.angular_velocity, static_cast<Index>(keyframe.size()), 0, 0};
    for (const MotionKey& key : motion.keys) keyframe.push_back({key.time, key.position, key.rotation});
    script.key_end = static_cast<Index>(keyframe.size());
    return script;
}

/// Returns the initial pose that is stored for a new object: its pose at time 0, at which its script starts. The object
/// has the pose `pose` at the time `now` and moves at constant velocities.
RigidMotion initial_of(const RigidPose& pose, const Motion& motion, Real now) {
    return {pose.position - now * motion.velocity, rotation_matrix(-now * motion.angular_velocity) * pose.rotation,
            Vec3::Zero(), Vec3::Zero()};
}

struct GeometryOf {
    ColliderGeometry operator()(const Plane&) const { return {ColliderShape::plane, Vec3::Zero()}; }
    ColliderGeometry operator()(const Sphere& s) const { return {ColliderShape::sphere, Vec3(s.radius, 0, 0)}; }
    ColliderGeometry operator()(const Box& s) const { return {ColliderShape::box, s.size / 2}; }
    ColliderGeometry operator()(const Capsule& s) const {
        return {ColliderShape::capsule, Vec3(s.radius, s.length / 2, 0)};
    }
    ColliderGeometry operator()(const Cylinder& s) const {
        return {ColliderShape::cylinder, Vec3(s.radius, s.height / 2, 0)};
    }
    ColliderGeometry operator()(const Bucket& s) const {
        return {ColliderShape::bucket, Vec3(s.radius, s.height, s.thickness)};
    }
    ColliderGeometry operator()(const SurfaceMesh&) const { return {ColliderShape::mesh, Vec3::Zero()}; }
};

/// The smallest rotation that rotates the z axis to `direction`. If `direction` is opposite to z, the result is a
/// rotation by 180 degrees about x.
Mat3 turn_from_z(const Vec3& direction) {
    const Vec3 axis(-direction.y(), direction.x(), 0);
    const Real sine = axis.norm();
    if (sine == 0) return direction.z() > 0 ? Mat3(Mat3::Identity()) : rotation_matrix(Vec3(std::numbers::pi, 0, 0));
    return rotation_matrix(axis * (std::atan2(sine, direction.z()) / sine));
}

/// Pose of the frame of a shape relative to the frame of its collider. In its own frame a plane is z = 0. For all other
/// shapes the two frames are equal.
RigidPose shape_frame(const Shape& shape) {
    if (const auto* plane = std::get_if<Plane>(&shape)) return {plane->point, turn_from_z(plane->normal)};
    return {Vec3::Zero(), Mat3::Identity()};
}

RigidPose compose(const RigidPose& outer, const RigidPose& inner) {
    return {outer.position + outer.rotation * inner.position, outer.rotation * inner.rotation};
}

/// Motion of the shape of a collider. Its keys are poses of the shape frame (see shape_frame), as in move_to and
/// set_pose. If no key has a rotation, the shape keeps the rotation of `placed`, its pose without keys.
Motion motion_of_shape(const Motion& motion, const RigidPose& placed) {
    Motion of_shape = motion;
    if (!motion.turns())
        for (MotionKey& key : of_shape.keys) key.rotation = rotation_vector(placed.rotation);
    return of_shape;
}

}  // namespace

SurfaceProperties surface_properties(const SurfaceSettings& settings) {
    constexpr Real left_to_others = -1;
    const Real friction = settings.friction.value_or(left_to_others);
    const Real dynamic = settings.dynamic_friction.value_or(friction);
    return {settings.static_friction.value_or(std::max(friction, dynamic)), dynamic,
            settings.restitution.value_or(left_to_others)};
}

Index append_attachment(Model& model, std::uint32_t slot, Index body, std::span<const Index> nodes,
                        const RigidPose& pose, const Motion& motion, Real now, const Mat3& held) {
    AttachmentTable& table = model.attachments;
    const std::size_t row = table.slot.size();
    AnyTable(table).resize(row + 1);
    table.slot[row] = slot;
    table.body[row] = body;
    table.held[row] = held;
    table.initial[row] = initial_of(pose, motion, now);
    table.script[row] = append_script(motion, table.keyframe);
    const RigidPose present = pose_at(table.script[row], table.keyframe, table.initial[row], now);
    table.motion[row] = {present.position, present.rotation, Vec3::Zero(), Vec3::Zero()};
    table.nodes[row].begin = static_cast<Index>(table.node.size());
    const auto b = static_cast<std::size_t>(body);
    for (Index local : nodes) {
        const auto n = static_cast<std::size_t>(model.bodies.nodes[b].begin + local);
        table.node.push_back(static_cast<Index>(n));
        table.anchor.push_back(present.rotation.transpose() * (model.nodes.position[n] - present.position));
        model.nodes.velocity[n] -= held * (held.transpose() * model.nodes.velocity[n]);
        if (!holds_completely(held)) continue;
        if (model.nodes.inverse_mass[n] > 0) ++model.bodies.pinned_count[b];
        model.nodes.inverse_mass[n] = 0;
        model.nodes.velocity[n] = Vec3::Zero();
    }
    table.nodes[row].end = static_cast<Index>(table.node.size());
    return static_cast<Index>(row);
}

void erase_attachment(Model& model, Index row) {
    AttachmentTable& table = model.attachments;
    const auto r = static_cast<std::size_t>(row);
    const auto body = static_cast<std::size_t>(table.body[r]);
    const bool complete = holds_completely(table.held[r]);
    for (Index i = table.nodes[r].begin; i < table.nodes[r].end && complete; ++i) {
        const Index node = table.node[static_cast<std::size_t>(i)];
        bool held_elsewhere = false;
        for (std::size_t other = 0; other < table.slot.size() && !held_elsewhere; ++other) {
            if (other == r || table.body[other] != table.body[r] || !holds_completely(table.held[other])) continue;
            for (Index j = table.nodes[other].begin; j < table.nodes[other].end; ++j)
                held_elsewhere |= table.node[static_cast<std::size_t>(j)] == node;
        }
        const auto n = static_cast<std::size_t>(node);
        const Real inverse_mass = model.free_inverse_mass(n);
        if (held_elsewhere || !(inverse_mass > 0)) continue;
        model.nodes.inverse_mass[n] = inverse_mass;
        --model.bodies.pinned_count[body];
    }
    std::vector<Index> row_now;
    for (Index i = 0; i < static_cast<Index>(table.slot.size()); ++i)
        row_now.push_back(i == row ? no_index : i - (i > row));
    const Range removed{row, row + 1};
    erase_scripted_rows({&removed, 1}, table);
    model.attachment_map.rows_moved(row_now);
}

Index append_collider(Model& model, Column<Real>& stiffness_sum, std::uint32_t slot, const Shape& shape,
                      const ColliderSettings& settings, Real now) {
    ColliderTable& table = model.colliders;
    const std::size_t row = table.slot.size();
    AnyTable(table).resize(row + 1);
    table.slot[row] = slot;
    table.geometry[row] = std::visit(GeometryOf{}, shape);
    const RigidPose placed = compose({settings.position, rotation_matrix(settings.rotation)}, shape_frame(shape));
    const Motion motion = motion_of_shape(settings.motion, placed);
    table.initial[row] = initial_of(placed, motion, now);
    table.script[row] = append_script(motion, table.keyframe);
    const RigidPose present = pose_at(table.script[row], table.keyframe, table.initial[row], now);
    table.motion[row] = {present.position, present.rotation, Vec3::Zero(), Vec3::Zero()};
    table.surface[row] = surface_properties(
        {settings.friction, settings.static_friction, settings.dynamic_friction, settings.restitution});
    table.material[row] = no_index;
    table.filter[row] = {settings.collision_group, settings.collision_mask};
    table.body[row] = no_index;
    table.travel[row] = 0;
    model.collider_records.push_back({.name = settings.name, .shape = shape});
    model.settled = false;

    if (const auto* surface = std::get_if<SurfaceMesh>(&shape)) {
        table.body[row] = append_body(model, stiffness_sum,
                                      {.slot = slot,
                                       .kind = BodyKind::kinematic,
                                       .self_contact = false,
                                       .material = no_index,
                                       .collider = static_cast<Index>(row),
                                       .contact_distance = settings.contact_distance,
                                       .nodes = surface->nodes,
                                       .tetrahedra = {},
                                       .triangles = surface->triangles,
                                       .position = present.position,
                                       .rotation = present.rotation,
                                       .velocity = Vec3::Zero(),
                                       .angular_velocity = Vec3::Zero()});
        std::vector<Index> all(surface->nodes.size());
        for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<Index>(n);
        append_attachment(model, no_slot, table.body[row], all, placed, motion, now);
    }
    return static_cast<Index>(row);
}

}  // namespace skerry
