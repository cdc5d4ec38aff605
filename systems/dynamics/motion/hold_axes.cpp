#include "systems/dynamics/motion/hold_axes.h"

#include <cstddef>

#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Calls visit(entry, node, direction, speed) for each direction along which an attachment holds a node, with the speed
/// that is prescribed along the direction.
void for_each_held(const AxisHoldInputs& inputs, Real h, auto&& visit) {
    for (std::size_t a = 0; a < inputs.nodes.size(); ++a) {
        if (holds_completely(inputs.held[a])) continue;
        const RigidMotion& motion = inputs.motion[a];
        const Vec3 end = motion.position + h * motion.velocity;
        const Mat3 rotation = rotation_matrix(h * motion.angular_velocity) * motion.rotation;
        for (auto i = static_cast<std::size_t>(inputs.nodes[a].begin);
             i < static_cast<std::size_t>(inputs.nodes[a].end); ++i) {
            const auto n = static_cast<std::size_t>(inputs.node[i]);
            if (!(inputs.inverse_mass[n] > 0) || inputs.resting.contain(n)) continue;
            const Vec3 velocity = (end + rotation * inputs.anchor[i] - inputs.position[n]) / h;
            for (const Vec3 direction : inputs.held[a].colwise())
                if (!direction.isZero(0)) visit(i, n, direction, direction.dot(velocity));
        }
    }
}

}  // namespace

ExternalWork hold_axes(const AxisHoldInputs& inputs, Real h, Real kick, Real lag, std::span<Vec3> velocity_next,
                       Column<Vec3>& held_impulse) {
    ExternalWork sum;
    held_impulse.assign(inputs.node.size(), Vec3::Zero());
    for_each_held(inputs, h, [&](std::size_t i, std::size_t n, const Vec3& direction, Real speed) {
        const Real impulse = inputs.mass[n] * (speed - direction.dot(velocity_next[n]));
        const Real gained = speed - direction.dot(inputs.velocity[n]);
        velocity_next[n] += impulse * inputs.inverse_mass[n] * direction;
        held_impulse[i] += impulse * direction;
        sum.impulse += impulse * direction;
        // The forces that this impulse balances do their work over the displacement at the end velocity, or with
        // leapfrog (lag = 0) at the mean velocity. The kinetic energy changes with the mean of the velocities before
        // and after.
        const Real during = lag == 0 ? speed - gained / 2 : speed;
        sum.work += impulse * during;
        if (lag != 0) sum.work -= inputs.mass[n] * gained * gained / 2;
        sum.work -= (h - kick) * inputs.mass[n] * direction.dot(inputs.gravity) * during;
        if (!inputs.load.empty()) sum.work -= (h - kick) * direction.dot(inputs.load[n]) * during;
    });
    return sum;
}

ExternalWork hold_axes_again(const AxisHoldInputs& inputs, Real h, std::span<Vec3> velocity_next,
                             std::span<Vec3> push_out, std::span<Vec3> held_impulse) {
    ExternalWork sum;
    for_each_held(inputs, h, [&](std::size_t i, std::size_t n, const Vec3& direction, Real speed) {
        push_out[n] -= direction.dot(push_out[n]) * direction;
        const Real before = direction.dot(velocity_next[n]);
        const Real impulse = inputs.mass[n] * (speed - before);
        velocity_next[n] += impulse * inputs.inverse_mass[n] * direction;
        held_impulse[i] += impulse * direction;
        sum.impulse += impulse * direction;
        sum.work += impulse * (before + speed) / 2;
    });
    return sum;
}

}  // namespace skerry
