// Law of one block of three joint rows. The relative velocity of a locked row is zero. The third row may be a free axis
// with limits and a motor (docs/methods/joints.md 2, 3).
#pragma once

#include <algorithm>

#include "components/types.h"

namespace skerry {

/// Velocity limits `low`, `high` and motor velocity `target` of the axis [m/s or rad/s], and the greatest impulse
/// `most` of the motor [N s or N m s]
struct AxisBounds {
    Real low = -infinity, high = infinity;
    Real target = 0, most = 0;
};

/// Returns the impulse r of the axis, where u = w r + b is the axis velocity and w the mobility. The motor drives u to
/// `target` within its greatest impulse. The limits `low` and `high` hold regardless of the motor.
inline Real answer_axis(const AxisBounds& axis, Real w, Real b) {
    if (!(w > 0)) return 0;
    const Real motor = axis.most > 0 ? std::clamp((axis.target - b) / w, -axis.most, axis.most) : 0;
    const Real u = b + w * motor;
    if (u < axis.low) return (axis.low - b) / w;
    if (u > axis.high) return (axis.high - b) / w;
    return motor;
}

/// Returns the part of the impulse `r` of the axis that the motor exerts at the axis velocity `u`. The rest is the
/// impulse of a limit.
inline Real motor_part(const AxisBounds& axis, Real w, Real u, Real r) {
    if (!(w > 0) || !(axis.most > 0)) return 0;
    if (axis.low == -infinity && axis.high == infinity) return r;
    return std::clamp(r + (axis.target - u) / w, -axis.most, axis.most);
}

/// Three joint rows with their diagonal block of W, in the frame of the joint.
struct JointLaw {
    bool axis_free;  // true: the third row is a free axis; false: the third row is locked
    AxisBounds axis{};
    Mat3 block;          // block of W
    Mat3 inverse;        // inverse of the locked part of the block
    Real axis_mobility;  // mobility of the axis while the locked rows hold (Schur complement)

    void prepare(const Mat3& of, bool with_axis);

    /// Returns the impulse r with u = W r + b, where u is zero in the locked rows.
    Vec3 answer(const AxisBounds& bounds, const Vec3& b) const {
        if (!axis_free) return -(inverse * b);
        const Vec3 held(b.x(), b.y(), 0), towards(block(0, 2), block(1, 2), 0);
        const Vec3 locked = inverse * held, along = inverse * towards;
        Vec3 r = -locked;
        r.z() = answer_axis(bounds, axis_mobility, b.z() - towards.dot(locked));
        r -= r.z() * along;
        return r;
    }
    Vec3 answer(const Vec3& b) const { return answer(axis, b); }

    /// Residual of the joint law at impulse r and velocity u, with the scalar `mobility` in place of W
    /// (docs/methods/errors.md 1).
    Vec3 natural_map(const Vec3& r, const Vec3& u, Real mobility) const {
        Vec3 residual = u / mobility;
        if (axis_free) residual.z() = r.z() - answer_axis(axis, mobility, u.z() - mobility * r.z());
        return residual;
    }
};

}  // namespace skerry
