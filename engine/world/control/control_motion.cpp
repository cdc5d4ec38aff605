// Changes of the motion of colliders and attachments. Each collider and attachment has a script: constant velocities
// since a start time, or keyframes.
#include <array>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/validate.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Access to the script of one collider or attachment. `table`: ColliderTable or AttachmentTable; `row`: row of the
/// object in this table.
template <class Table>
struct Scripted {
    Table& table;
    std::size_t row;

    RigidPose pose(Real now) const { return pose_at(script(), table.keyframe, table.initial[row], now); }
    MotionScript& script() const { return table.script[row]; }
    bool has_keys() const { return script().key_begin != script().key_end; }
    std::span<const Keyframe> keys() const {
        return table.keyframe.span().subspan(static_cast<std::size_t>(script().key_begin),
                                             static_cast<std::size_t>(script().key_end - script().key_begin));
    }

    void erase_keys() const {
        const Index begin = script().key_begin, count = script().key_end - begin;
        table.keyframe.erase(static_cast<std::size_t>(begin), static_cast<std::size_t>(count));
        for (MotionScript& other : table.script)
            if (other.key_begin > begin) {
                other.key_begin -= count;
                other.key_end -= count;
            }
        script().key_begin = script().key_end = static_cast<Index>(table.keyframe.size());
    }
    /// Replaces the script of a collider or attachment by constant velocities that start at `pose` at the time `now`.
    void start(const RigidPose& pose, const Vec3& velocity, const Vec3& angular_velocity, Real now) const {
        if (has_keys()) erase_keys();
        script().velocity = velocity;
        script().angular_velocity = angular_velocity;
        script().start = now;
        table.initial[row] = {pose.position, pose.rotation, Vec3::Zero(), Vec3::Zero()};
    }
    /// Replaces the script by the key `start` and the poses `poses`. A rotation has many rotation vectors, which differ
    /// by full revolutions. Each key gets the vector nearest to that of the previous key, so that the object makes no
    /// additional revolution.
    void start_keys(const Keyframe& start, std::span<const Keyframe> poses) const {
        if (keys().size() != poses.size() + 1) {
            erase_keys();
            for (std::size_t k = 0; k <= poses.size(); ++k) table.keyframe.push_back({});
            script().key_end = static_cast<Index>(table.keyframe.size());
        }
        script().velocity = script().angular_velocity = Vec3::Zero();
        script().start = 0;
        Keyframe* key = &table.keyframe[static_cast<std::size_t>(script().key_begin)];
        *key = start;
        for (const Keyframe& next : poses) {
            key[1] = {next.time, next.position, nearest_turn(next.rotation, key->rotation)};
            ++key;
        }
    }
};

template <class Table>
Scripted(Table&, std::size_t) -> Scripted<Table>;

/// Makes a rotation matrix orthogonal again. Products of many rotations accumulate rounding errors.
RigidPose without_rounding(const RigidPose& pose) {
    return {pose.position, Eigen::Quaternion<Real>(pose.rotation).normalized().toRotationMatrix()};
}

bool is_at(const RigidPose& pose, const Pose& target) {
    return pose.position == target.position &&
           (rotation_vector(pose.rotation) == target.rotation || pose.rotation == rotation_matrix(target.rotation));
}

/// Sets constant velocities from now on. Returns false if the script already has these velocities.
template <class Table>
bool set_velocity(const Scripted<Table>& scripted, const Vec3& velocity, const Vec3& angular_velocity, Real now) {
    const MotionScript& script = scripted.script();
    if (!scripted.has_keys() && script.velocity == velocity && script.angular_velocity == angular_velocity)
        return false;
    scripted.start(without_rounding(scripted.pose(now)), velocity, angular_velocity, now);
    return true;
}

/// Gives an object a script that moves it from its present pose to each of the poses `poses` in turn, with constant
/// velocities between them. Keeps the present script if the object already rests at the last pose or is on its way
/// there.
template <class Table>
void follow(const Scripted<Table>& scripted, std::span<const Keyframe> poses, Real now) {
    const RigidPose present = scripted.pose(now);
    const MotionScript& script = scripted.script();
    const Pose end{poses.back().position, poses.back().rotation};
    const bool is_still = scripted.has_keys()
                              ? !(now < scripted.keys().back().time)
                              : script.velocity == Vec3::Zero() && script.angular_velocity == Vec3::Zero();
    if (is_still && is_at(present, end)) return;
    // the present script may already move the object to the last pose by the same time
    const bool has_target = scripted.keys().size() == poses.size() + 1;
    if (has_target && scripted.keys().back().time == poses.back().time && scripted.keys().front().time <= now &&
        is_at({scripted.keys().back().position, rotation_matrix(scripted.keys().back().rotation)}, end))
        return;
    scripted.start_keys({now, present.position, rotation_vector(present.rotation)}, poses);
}

template <class Table>
RigidPose set_pose(const Scripted<Table>& scripted, const Pose& pose, Real now) {
    const RigidPose there{pose.position, rotation_matrix(pose.rotation)};
    const Vec3 velocity = scripted.script().velocity, angular_velocity = scripted.script().angular_velocity;
    scripted.start(there, velocity, angular_velocity, now);
    return there;
}

/// Returns the attachment that moves the nodes of a mesh collider, or no_index for an analytic collider.
Index attachment_of(const Model& model, Index collider) {
    const Index body = model.colliders.body[static_cast<std::size_t>(collider)];
    if (body == no_index) return no_index;
    for (std::size_t a = 0; a < model.attachments.slot.size(); ++a)
        if (model.attachments.slot[a] == no_slot && model.attachments.body[a] == body) return static_cast<Index>(a);
    return no_index;
}

/// Title of a collider in error messages, such as "collider 'finger'".
std::string title_of(const Model& model, Index collider) {
    return "collider '" + model.collider_records[static_cast<std::size_t>(collider)].name + "'";
}
std::string title_of_attachment(const Model& model, std::size_t attachment) {
    const auto body = static_cast<std::size_t>(model.attachments.body[attachment]);
    return "attachment of body '" + model.body_records[body].name + "'";
}

/// Calls `change` for the script of a collider. For a mesh collider, also calls `change` for the script of the
/// attachment that moves the mesh.
void for_each_script(Model& model, Index collider, auto&& change) {
    change(Scripted{model.colliders, static_cast<std::size_t>(collider)});
    if (const Index a = attachment_of(model, collider); a != no_index)
        change(Scripted{model.attachments, static_cast<std::size_t>(a)});
}

/// Positions of all nodes of a body after one of its attachments was moved from the pose `old_pose` to `pose`:
/// - Nodes that the attachment holds move with it. If it holds them in some directions only, they move in these only.
/// - Nodes that no attachment holds completely move rigidly with it if it holds the rotating frame of an implicit body.
/// - All other nodes stay.
std::vector<Vec3> carried_nodes(const Model& model, std::size_t attachment, const RigidPose& old_pose,
                                const RigidPose& pose) {
    const AttachmentTable& table = model.attachments;
    const Range nodes = model.bodies.nodes[static_cast<std::size_t>(table.body[attachment])];
    const std::span<const Vec3> present = model.nodes.position.span().subspan(static_cast<std::size_t>(nodes.begin),
                                                                              static_cast<std::size_t>(nodes.size()));
    std::vector<Vec3> position(present.begin(), present.end());
    const Range frame = model.bodies.rigid[static_cast<std::size_t>(table.body[attachment])];
    if (frame.size() > 0 &&
        model.rigid_bodies.holder[static_cast<std::size_t>(frame.begin)] == static_cast<Index>(attachment))
        for (std::size_t n = 0; n < position.size(); ++n)
            if (model.nodes.inverse_mass[static_cast<std::size_t>(nodes.begin) + n] > 0)
                position[n] =
                    pose.position + pose.rotation * (old_pose.rotation.transpose() * (present[n] - old_pose.position));
    for (Index i = table.nodes[attachment].begin; i < table.nodes[attachment].end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        Vec3& x = position[static_cast<std::size_t>(table.node[at] - nodes.begin)];
        const Vec3 target = pose.position + pose.rotation * table.anchor[at];
        const Mat3& held = table.held[attachment];
        x = holds_completely(held) ? target : Vec3(x + held * (held.transpose() * (target - x)));
    }
    return position;
}

// In the following functions `object` is a function that returns the name of the object for error messages. It is
// called only if a value is refused, so that control loops allocate no memory.

void require_velocities(auto&& object, const Vec3& velocity, const Vec3& angular_velocity) {
    if (velocity.allFinite() && angular_velocity.allFinite()) return;
    require_finite(object(), "velocity", velocity);
    require_finite(object(), "angular_velocity", angular_velocity);
}

void require_pose(auto&& object, const Pose& pose) {
    if (!pose.position.allFinite() || !pose.rotation.allFinite()) validate(pose, object());
}

void require_duration(auto&& object, Real duration, Real now) {
    if (std::isfinite(duration) && duration > 0 && now + duration > now) return;
    refuse(object(), "duration", short_text(duration), "a time > 0 (s)",
           "to move " + object() + " at once, call set_pose");
}

}  // namespace

void World::set_velocity(ColliderHandle collider, const Vec3& velocity, const Vec3& angular_velocity) {
    state_->require_between_steps("set_velocity");
    const Index row = state_->model.row(collider, "set_velocity");
    require_velocities([&] { return title_of(state_->model, row); }, velocity, angular_velocity);
    for_each_script(state_->model, row,
                    [&](const auto& scripted) { skerry::set_velocity(scripted, velocity, angular_velocity, time()); });
}

void World::set_velocity(AttachmentHandle attachment, const Vec3& velocity, const Vec3& angular_velocity) {
    state_->require_between_steps("set_velocity");
    const auto row = static_cast<std::size_t>(state_->model.row(attachment, "set_velocity"));
    require_velocities([&] { return title_of_attachment(state_->model, row); }, velocity, angular_velocity);
    skerry::set_velocity(Scripted{state_->model.attachments, row}, velocity, angular_velocity, time());
}

void follow_poses(World& world, ColliderHandle collider, std::span<const Keyframe> poses) {
    WorldState& state = state_between_steps(world, "move_to");
    for_each_script(state.model, state.model.row(collider, "move_to"),
                    [&](const auto& scripted) { follow(scripted, poses, world.time()); });
}

void follow_poses(World& world, AttachmentHandle attachment, std::span<const Keyframe> poses) {
    WorldState& state = state_between_steps(world, "move_to");
    const auto row = static_cast<std::size_t>(state.model.row(attachment, "move_to"));
    follow(Scripted{state.model.attachments, row}, poses, world.time());
}

void World::move_to(ColliderHandle collider, const Pose& pose, Real duration) {
    state_->require_between_steps("move_to");
    const Index row = state_->model.row(collider, "move_to");
    const auto object = [&] { return title_of(state_->model, row); };
    require_pose(object, pose);
    require_duration(object, duration, time());
    follow_poses(*this, collider, std::array{Keyframe{time() + duration, pose.position, pose.rotation}});
}

void World::move_to(AttachmentHandle attachment, const Pose& pose, Real duration) {
    state_->require_between_steps("move_to");
    const auto row = static_cast<std::size_t>(state_->model.row(attachment, "move_to"));
    const auto object = [&] { return title_of_attachment(state_->model, row); };
    require_pose(object, pose);
    require_duration(object, duration, time());
    follow_poses(*this, attachment, std::array{Keyframe{time() + duration, pose.position, pose.rotation}});
}

void World::set_pose(ColliderHandle collider, const Pose& pose) {
    state_->require_between_steps("set_pose");
    Model& model = state_->model;
    const Index row = model.row(collider, "set_pose");
    require_pose([&] { return title_of(model, row); }, pose);
    const auto c = static_cast<std::size_t>(row);
    if (is_at(Scripted{model.colliders, c}.pose(time()), pose)) return;
    // wakes bodies that rest on the collider at its old position and may lose their support
    state_->edits.places.add_collider(model, c, time());
    const RigidPose there = skerry::set_pose(Scripted{model.colliders, c}, pose, time());
    if (const Index a = attachment_of(model, row); a != no_index) {
        const auto of_mesh = static_cast<std::size_t>(a);
        skerry::set_pose(Scripted{model.attachments, of_mesh}, pose, time());
        place_nodes(*state_, static_cast<std::size_t>(model.colliders.body[c]),
                    carried_nodes(model, of_mesh, there, there));
    }
    model.colliders.motion[c] = {there.position, there.rotation, Vec3::Zero(), Vec3::Zero()};
    model.collider_records[c].settled = model.settled = false;
    state_->cache.forget_collider(model, c);
    state_->edits.places.add_collider(model, c, time());  // at its new position the collider may touch other bodies
}

void World::set_pose(AttachmentHandle attachment, const Pose& pose) {
    state_->require_between_steps("set_pose");
    Model& model = state_->model;
    const auto a = static_cast<std::size_t>(model.row(attachment, "set_pose"));
    const auto object = [&] { return title_of_attachment(model, a); };
    require_pose(object, pose);
    const Scripted scripted{model.attachments, a};
    if (is_at(scripted.pose(time()), pose)) return;
    const auto body = static_cast<std::size_t>(model.attachments.body[a]);
    const std::vector<Vec3> position =
        carried_nodes(model, a, scripted.pose(time()), {pose.position, rotation_matrix(pose.rotation)});
    require_upright(model, body, position, object(), "pose");
    skerry::set_pose(scripted, pose, time());
    place_nodes(*state_, body, position);
    if (model.is_rigid(body)) {
        const RigidFit fit = fit_rigid_body(model, body, position);
        set_rigid_pose(model, body, fit.center, fit.rotation);
    } else if (model.has_frame(body)) {
        follow_attachments(model, body);
    }
}

MotionKey World::pose(AttachmentHandle attachment) const {
    const auto row = static_cast<std::size_t>(state_->model.row(attachment, "pose"));
    const RigidPose pose = Scripted{state_->model.attachments, row}.pose(time());
    return {time(), pose.position, rotation_vector(pose.rotation)};
}

}  // namespace skerry
