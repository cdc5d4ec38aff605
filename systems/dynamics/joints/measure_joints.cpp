#include "systems/dynamics/joints/measure_joints.h"

#include <Eigen/Geometry>

namespace skerry {

namespace {

/// Twice the mean velocity of a body in this step: the sum of its velocities before and after the step, at the point of
/// a joint block [m/s]. For a block of rotations: the sum of its angular velocities before and after the step [rad/s].
Vec3 velocity_sum(const JointWorkInputs& joints, const JointBlock& block, Index body) {
    const auto r = static_cast<std::size_t>(body);
    const Vec3 angular = 2 * joints.angular_momentum[r] + joints.moment_kick[r] + joints.contact_moment[r];
    const Vec3 spin = joints.inverse_inertia[r] * angular;
    if (block.turning) return spin;
    const Vec3 momentum = 2 * joints.momentum[r] + joints.kick[r] + joints.contact_impulse[r];
    return momentum / joints.mass[r] + spin.cross(block.point - joints.center[r]);
}

}  // namespace

JointMeasures measure_joints(const JointWorkInputs& joints) {
    JointMeasures sum;
    for (std::size_t i = 0; i < joints.block.size(); ++i) {
        const JointBlock& block = joints.block[i];
        const Vec3 impulse = block.frame * joints.impulse[i];
        const bool first = block.first_node != no_index, second = block.second_node != no_index;
        if ((first || second) && joints.ghosts.contain(joints.body[first ? block.first : block.second])) continue;
        if (first) sum.work += impulse.dot(velocity_sum(joints, block, block.first)) / 2;
        if (second) sum.work -= impulse.dot(velocity_sum(joints, block, block.second)) / 2;
        if (!block.turning && first != second) sum.impulse += first ? impulse : Vec3(-impulse);
    }
    return sum;
}

}  // namespace skerry
