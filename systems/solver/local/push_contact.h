// Split impulse of one contact: corrects penetration by moving positions only (docs/methods/contact.md 3.4). As a
// velocity the correction would add energy (docs/methods/time_stepping.md 2.3).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// Gaps above minus this value are not corrected. A resting contact solved to 1e-3 loses at most g h^2 / 1000 per step,
/// so the first part is a hundred steps of drift. The second part is the rounding of positions some kilometres from the
/// origin [m]
inline Real push_slop(Real gravity, Real h) {
    constexpr Real of_kick = 0.1, rounding = 1e-12;  // fraction of g h^2; [m]
    return of_kick * gravity * h * h + rounding;
}

/// Correction speed for a penetration `depth`. It is limited so that m v^2 / 2 is half a thousandth of the work of
/// lifting the mass m by `depth`, or to a hundredth of recovery_speed if that is more (docs/methods/contact.md 3.4)
/// [m/s]
inline Real push_speed(const SolverSettings& settings, Real gravity, Real depth, Real h) {
    constexpr Real of_fall = 0.03, of_limit = 0.01;  // fractions of sqrt(gravity depth) and of recovery_speed
    const Real cheap = std::max(of_fall * std::sqrt(gravity * depth), of_limit * settings.recovery_speed);
    return std::min({settings.recovery * depth / h, settings.recovery_speed, cheap});
}

/// Lower bound of p_n, negated: negative values request a push. A contact that is not pressed in requests none, even if
/// the velocity solve left an error. So a region without a pressed contact yields zero, alone or within a larger one.
/// `normal_velocity`: u_n [m/s]
inline Real push_bias(Real normal_velocity, Real gap, Real slop, const SolverSettings& settings, Real gravity, Real h) {
    if (gap < -slop) return normal_velocity - push_speed(settings, gravity, -gap, h);
    return std::max(Real(0), normal_velocity + std::max(gap, Real(0)) / h);
}

/// Variant for contacts whose gap shrinks by rotation at the speed `loss` (m/s, below 0), which the velocities do not
/// include. Requests compensation of the loss as far as the gap cannot absorb it.
inline Real push_bias_turned(Real bias, Real normal_velocity, Real gap, Real slop, Real loss, Real h) {
    if (gap < -slop) return bias + loss;
    const Real left = normal_velocity + std::max(gap, Real(0)) / h + loss;
    return left < 0 ? std::max(left, loss) : left;
}

/// Gauss-Seidel step of one contact on the pseudo velocities; `apply` moves nodes by an impulse. Returns D change^2.
template <class Apply>
inline Real push_contact(const LumpedContact& contact, Real bias, Vec4* velocity, Real& impulse, const Apply& apply) {
    Real along = bias;
    for (Index a = 0; a < contact.node_count; ++a)
        along += contact.weight[a] * contact.normal.dot(velocity[contact.node[a]]);
    const Real next = std::max(Real(0), impulse - contact.inverse_diagonal * along);
    const Real change = next - impulse;
    if (change == 0) return 0;
    apply(contact, change * contact.normal, velocity);
    impulse = next;
    return contact.diagonal * change * change;
}

struct PushMemory {
    std::span<Real> impulse, bias;  // by contact
};

}  // namespace skerry
