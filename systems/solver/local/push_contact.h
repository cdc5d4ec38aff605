// The split impulse of one contact: takes it back out by moving positions only (docs/methods/contact.md 3.4; as a
// velocity it would add energy, docs/methods/time_stepping.md 2.3).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// m, gaps above minus this are not worth a push: a resting contact solved to 1e-3 loses at most a thousandth of g h^2
/// a step, so this is a hundred steps of drift; the second part is the rounding of positions some kilometres from the
/// origin.
inline Real push_slop(Real gravity, Real h) {
    constexpr Real of_kick = 0.1, rounding = 1e-12;  // of g h^2; m
    return of_kick * gravity * h * h + rounding;
}

/// m/s, how fast something `depth` deep is pushed out: no faster than costs next to nothing, m v^2 / 2 half a
/// thousandth of what lifting the mass m by `depth` takes, or a hundredth of the limit (docs/methods/contact.md 3.4).
inline Real push_speed(const SolverSettings& settings, Real gravity, Real depth, Real h) {
    constexpr Real of_fall = 0.03, of_limit = 0.01;  // of the root of gravity times depth, and of recovery_speed
    const Real cheap = std::max(of_fall * std::sqrt(gravity * depth), of_limit * settings.recovery_speed);
    return std::min({settings.recovery * depth / h, settings.recovery_speed, cheap});
}

/// The least u_n + p_n of a contact, taken from u_n: negative asks for a push. Contacts that are not pressed in ask for
/// nothing, whatever error the velocity solve has left: so a region without a pressed contact comes out as zero, on its
/// own or within a larger one. `normal_velocity`: u_n, m/s.
inline Real push_bias(Real normal_velocity, Real gap, Real slop, const SolverSettings& settings, Real gravity, Real h) {
    if (gap < -slop) return normal_velocity - push_speed(settings, gravity, -gap, h);
    return std::max(Real(0), normal_velocity + std::max(gap, Real(0)) / h);
}

/// The same where a turn takes `loss` (m/s, below 0) in the step, which velocities do not know of: that is given back,
/// as far as the gap does not have it.
inline Real push_bias_turned(Real bias, Real normal_velocity, Real gap, Real slop, Real loss, Real h) {
    if (gap < -slop) return bias + loss;
    const Real left = normal_velocity + std::max(gap, Real(0)) / h + loss;
    return left < 0 ? std::max(left, loss) : left;
}

/// The Gauss-Seidel step of one contact on the pseudo velocities; `apply` moves nodes by an impulse. Returns D
/// change^2.
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
    std::span<Vec4> velocity;       // by node of the region; the result
};

}  // namespace skerry
