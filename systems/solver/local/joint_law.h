// Law of one block of three joint rows. The relative velocity of a locked row is zero. The third row may be a free axis
// with limits, a motor and passive forces (docs/methods/joints.md 2, 3).
#pragma once

#include <algorithm>

#include "components/joint_table.h"
#include "components/types.h"

namespace skerry {

/// Limits, motor and passive forces of an axis in this step.
struct AxisBounds {
    Real low = -infinity, high = infinity;  // velocity limits [m/s or rad/s]
    Real target = 0, max_impulse = 0;       // velocity [m/s or rad/s] and greatest impulse [N s or N m s] of the motor
    Real friction = 0;                      // greatest impulse of dry friction [N s or N m s]
    // Impulse of spring and damper at the axis velocity u: pull - drag u [N s or N m s].
    Real pull = 0;
    Real drag = 0;
};

/// Returns the impulse of motor and dry friction together, where u = w r + b is the axis velocity and w the mobility.
/// The motor drives u to its target, and friction drives u to zero, both within their greatest impulses.
inline Real drive_impulse(const AxisBounds& axis, Real w, Real b) {
    // Motor and friction are two drives, each with a target velocity (0 for friction) and a greatest impulse.
    // `lower_drive`, `upper_drive`: greatest impulses of the drives with the lower and with the higher target. The sum
    // of the impulses of both drives depends on u:
    // - below the lower target: lower_drive + upper_drive
    // - between the targets: upper_drive - lower_drive
    // - above the higher target: -lower_drive - upper_drive
    // - at a target: any value between those on both sides
    const bool motor_is_lower = axis.target < 0;
    const Real lower_drive = motor_is_lower ? axis.max_impulse : axis.friction,
               upper_drive = motor_is_lower ? axis.friction : axis.max_impulse;
    const Real near_lower_target =
        std::clamp((std::min(axis.target, Real(0)) - b) / w, upper_drive - lower_drive, upper_drive + lower_drive);
    if (near_lower_target > upper_drive - lower_drive) return near_lower_target;
    return std::clamp((std::max(axis.target, Real(0)) - b) / w, -upper_drive - lower_drive, upper_drive - lower_drive);
}

/// Returns the impulse r of the axis, where u = w r + b is the axis velocity and w the mobility. The limits `low` and
/// `high` hold regardless of all other forces.
inline Real solve_axis(const AxisBounds& axis, Real w, Real b) {
    if (!(w > 0)) return 0;
    // u = w (drive + pull - drag u) + b, solved for u: u = w_damped drive + b_damped
    const Real share = 1 / (1 + w * axis.drag), w_damped = share * w, b_damped = share * (b + w * axis.pull);
    const Real drive = drive_impulse(axis, w_damped, b_damped);
    const Real u = b_damped + w_damped * drive;
    if (u < axis.low) return (axis.low - b) / w;
    if (u > axis.high) return (axis.high - b) / w;
    return drive + (axis.pull - axis.drag * u);
}

/// Parts of the impulse `r` of the axis that the motor and the passive forces (spring, damper, friction) exert at the
/// axis velocity `u`. The rest is the impulse of a limit.
inline AxisImpulses parts_of(const AxisBounds& axis, Real w, Real u, Real r) {
    if (!(w > 0)) return {};
    const Real spring = axis.pull - axis.drag * u;
    Real drive = r - spring;
    if (axis.low != -infinity || axis.high != infinity) {
        const Real share = 1 / (1 + w * axis.drag);
        drive = drive_impulse(axis, share * w, share * (u - w * r + w * axis.pull));
    }
    if (!(axis.max_impulse > 0)) return {0, spring + drive};
    if (!(axis.friction > 0)) return {drive, spring};
    // `lower_drive`, `upper_drive`: as in drive_impulse. If the sum of both drives is at least upper_drive -
    // lower_drive, the axis is not faster than the lower target, and the upper drive has its full strength. Otherwise
    // the lower drive brakes with full strength.
    const bool motor_is_lower = axis.target < 0;
    const Real lower_drive = motor_is_lower ? axis.max_impulse : axis.friction,
               upper_drive = motor_is_lower ? axis.friction : axis.max_impulse;
    const Real lower_impulse = drive >= upper_drive - lower_drive ? drive - upper_drive : -lower_drive;
    const Real motor = motor_is_lower ? lower_impulse : drive - lower_impulse;
    return {motor, spring + (drive - motor)};
}

/// Three joint rows with their diagonal block of the Delassus operator W, in the frame of the joint.
struct JointLaw {
    bool axis_free;  // true: the third row is a free axis; false: the third row is locked
    AxisBounds axis{};
    Mat3 block;          // diagonal block of W of the three rows
    Mat3 inverse;        // inverse of the locked rows and columns of `block`; 0 in the row and column of a free axis
    Real axis_mobility;  // mobility of the axis while the locked rows hold (Schur complement)
    // Coefficient of the axis velocity in a mimic equation, which couples two joints. If it is not 0, this equation
    // replaces the three rows.
    Real mimic = 0;

    void prepare(const Mat3& delassus_block, bool with_axis);

    /// Returns the impulse r with u = W r + b, where u is zero in the locked rows.
    Vec3 solve(const AxisBounds& bounds, const Vec3& b) const {
        if (!axis_free) return -(inverse * b);
        const Vec3 held(b.x(), b.y(), 0), towards(block(0, 2), block(1, 2), 0);
        const Vec3 locked = inverse * held, along = inverse * towards;
        Vec3 r = -locked;
        r.z() = solve_axis(bounds, axis_mobility, b.z() - towards.dot(locked));
        r -= r.z() * along;
        return r;
    }
    Vec3 solve(const Vec3& b) const { return solve(axis, b); }

    /// Residual of the joint law at impulse r and velocity u, with the scalar `mobility` in place of W
    /// (docs/methods/errors.md 1).
    Vec3 natural_map(const Vec3& r, const Vec3& u, Real mobility) const {
        Vec3 residual = u / mobility;
        if (axis_free) residual.z() = r.z() - solve_axis(axis, mobility, u.z() - mobility * r.z());
        return residual;
    }
};

}  // namespace skerry
