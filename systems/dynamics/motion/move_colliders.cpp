#include "systems/dynamics/motion/move_colliders.h"

#include <algorithm>

#include "components/check.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

bool are_parallel(const Vec3& a, const Vec3& b) {
    constexpr Real parallel = 1e-12;  // two axes count as parallel if the sine of their angle is at most this value
    return a.cross(b).squaredNorm() <= parallel * parallel * a.squaredNorm() * b.squaredNorm();
}

/// Rotation at the fraction `s` of the way from the rotation of key `a` to the rotation of key `b`.
Mat3 rotation_between(const Vec3& a, const Vec3& b, Real s) {
    if (are_parallel(a, b)) return rotation_matrix(a + s * (b - a));
    return rotation_matrix(s * turn_between(a, b)) * rotation_matrix(a);
}

}  // namespace

Vec3 turn_between(const Vec3& a, const Vec3& b) {
    return are_parallel(a, b) ? Vec3(b - a) : rotation_vector(rotation_matrix(b) * rotation_matrix(a).transpose());
}

Real fastest_turn(const MotionScript& script, std::span<const Keyframe> keyframe) {
    if (script.key_begin == script.key_end) return script.angular_velocity.norm();
    Real fastest = 0;
    for (auto k = static_cast<std::size_t>(script.key_begin) + 1; k < static_cast<std::size_t>(script.key_end); ++k) {
        const Keyframe &a = keyframe[k - 1], &b = keyframe[k];
        fastest = std::max(fastest, turn_between(a.rotation, b.rotation).norm() / (b.time - a.time));
    }
    return fastest;
}

RigidPose pose_at(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial, Real t) {
    const std::span<const Keyframe> keys = keyframe.subspan(
        static_cast<std::size_t>(script.key_begin), static_cast<std::size_t>(script.key_end - script.key_begin));
    if (keys.empty()) {
        const Real since = t - script.start;
        return {initial.position + since * script.velocity,
                rotation_matrix(since * script.angular_velocity) * initial.rotation};
    }
    const auto after =
        std::upper_bound(keys.begin(), keys.end(), t, [](Real time, const Keyframe& key) { return time < key.time; });
    if (after == keys.begin()) return {keys.front().position, rotation_matrix(keys.front().rotation)};
    if (after == keys.end()) return {keys.back().position, rotation_matrix(keys.back().rotation)};
    const Keyframe &a = *(after - 1), &b = *after;
    const Real s = (t - a.time) / (b.time - a.time);
    return {a.position + s * (b.position - a.position), rotation_between(a.rotation, b.rotation, s)};
}

RigidMotion motion_of_step(const MotionScript& script, std::span<const Keyframe> keyframe, const RigidMotion& initial,
                           Real t, Real h) {
    const RigidPose now = pose_at(script, keyframe, initial, t);
    if (script.key_begin == script.key_end)
        return {now.position, now.rotation, script.velocity, script.angular_velocity};
    const RigidPose end = pose_at(script, keyframe, initial, t + h);
    return {now.position, now.rotation, (end.position - now.position) / h,
            rotation_vector(end.rotation * now.rotation.transpose()) / h};
}

void move_colliders(const ColliderMotionInputs& colliders, Real t, Real h, std::span<RigidMotion> motion) {
    SKERRY_CHECK(colliders.script.size() == motion.size() && colliders.initial.size() == motion.size());
    for (std::size_t c = 0; c < motion.size(); ++c)
        motion[c] = motion_of_step(colliders.script[c], colliders.keyframe, colliders.initial[c], t, h);
}

void drive_nodes(const NodeMotionInputs& followers, Real h, std::span<const Vec3> position, std::span<Vec3> velocity) {
    for (std::size_t f = 0; f < followers.nodes.size(); ++f) {
        if (!holds_completely(followers.held[f])) continue;
        const RigidMotion& motion = followers.motion[f];
        const Vec3 end = motion.position + h * motion.velocity;
        const Mat3 rotation = rotation_matrix(h * motion.angular_velocity) * motion.rotation;
        const Range nodes = followers.nodes[f];
        for (std::size_t i = static_cast<std::size_t>(nodes.begin); i < static_cast<std::size_t>(nodes.end); ++i) {
            const std::size_t n = static_cast<std::size_t>(followers.node[i]);
            velocity[n] = (end + rotation * followers.anchor[i] - position[n]) / h;
        }
    }
}

}  // namespace skerry
