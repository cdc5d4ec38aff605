// Split impulse of one contact: it corrects penetration by moving positions only (docs/methods/contact.md 3.4). A
// correction by velocities would add energy (docs/methods/time_stepping.md 2.3).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// Penetrations up to this depth are not corrected [m]. The first term is the drift of a hundred steps: with the
/// tolerance 1e-3, a resting contact sinks by at most g h^2 / 1000 per step. The second term is the rounding error of
/// positions some kilometres from the origin.
inline Real push_slop(Real gravity, Real h) {
    constexpr Real of_kick = 0.1, rounding = 1e-12;  // fraction of g h^2; rounding error of positions [m]
    return of_kick * gravity * h * h + rounding;
}

/// Speed at which a penetration `depth` is corrected (docs/methods/contact.md 3.4) [m/s].
inline Real push_speed(const SolverSettings& settings, Real gravity, Real depth, Real h) {
    // Bounds of the speed, as fractions of sqrt(gravity depth) and of recovery_speed.
    constexpr Real of_fall = 0.03, of_limit = 0.01;
    // Limits the kinetic energy m v^2 / 2 to half a thousandth of the work of lifting the mass m by `depth`. Without
    // gravity a hundredth of recovery_speed remains.
    const Real cheap = std::max(of_fall * std::sqrt(gravity * depth), of_limit * settings.recovery_speed);
    return std::min({settings.recovery * depth / h, settings.recovery_speed, cheap});
}

/// Returns the bias b of the condition p_n + b >= 0 on the normal pseudo velocity p_n, which moves positions only
/// [m/s]. A negative bias requests a push. `normal_velocity`: normal velocity after the velocity solve.
///
/// A contact that does not penetrate requests no push, even if the velocity solve left an error. So groups of contacts
/// without penetration get zero pseudo velocities, alone or in one region with other groups.
inline Real push_bias(Real normal_velocity, Real gap, Real slop, const SolverSettings& settings, Real gravity, Real h) {
    if (gap < -slop) return normal_velocity - push_speed(settings, gravity, -gap, h);
    return std::max(Real(0), normal_velocity + std::max(gap, Real(0)) / h);
}

/// Version of push_bias for a contact point that moves on an arc, because a body rotates [m/s]. `bias`: result of
/// push_bias. `loss` <= 0: rate of change of the gap by the arc, which the contact velocity does not include. The push
/// compensates
/// - the whole loss at a penetrating contact,
/// - only the part that would make the gap negative at any other contact.
inline Real push_bias_turned(Real bias, Real normal_velocity, Real gap, Real slop, Real loss, Real h) {
    if (gap < -slop) return bias + loss;
    const Real left = normal_velocity + std::max(gap, Real(0)) / h + loss;
    return left < 0 ? std::max(left, loss) : left;
}

/// Part of the velocity `u` that a tie demands to be zero: all of it (weld), or the part along the normal (slide).
inline Vec4 held_part(const LumpedContact& tie, const Vec4& u) {
    return tie.friction.stick == 0 ? Vec4(tie.normal.dot(u) * tie.normal) : u;
}

/// Gauss-Seidel step of one contact or tie on the pseudo velocities. `apply` changes the pseudo velocities by an
/// impulse. Returns D (change of the impulse)^2 with the mobility D (LumpedContact::diagonal) [J]
template <class Apply>
inline Real push_contact(const LumpedContact& contact, Real bias, Vec4* velocity, Real& impulse, const Apply& apply) {
    Vec4 pushed = Vec4::Zero();
    for (Index a = 0; a < contact.node_count; ++a) pushed += contact.weight[a] * velocity[contact.node[a]];
    if (contact.friction.ties()) {
        const Vec4 change = -contact.inverse_diagonal * held_part(contact, pushed);
        if (change.isZero(0)) return 0;
        apply(contact, change, velocity);
        return contact.diagonal * change.squaredNorm();
    }
    const Real next = std::max(Real(0), impulse - contact.inverse_diagonal * (bias + contact.normal.dot(pushed)));
    const Real change = next - impulse;
    if (change == 0) return 0;
    apply(contact, change * contact.normal, velocity);
    impulse = next;
    return contact.diagonal * change * change;
}

struct PushMemory {
    std::span<Real> impulse, bias;  // by contact: push impulse [N s]; right-hand side b of push_bias [m/s]
};

}  // namespace skerry
