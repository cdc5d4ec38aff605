// What a joint does with three rows of one joint: those that are locked are equations, its axis has limits and a motor
// (docs/methods/joints.md 2, 3).
#pragma once

#include <algorithm>
#include <limits>

#include "components/types.h"

namespace skerry {

/// Velocities of the axis, m/s or rad/s, and the greatest impulse of its motor, N s or N m s.
struct AxisBounds {
    Real low = -std::numeric_limits<Real>::infinity(), high = std::numeric_limits<Real>::infinity();
    Real target = 0, most = 0;
};

/// r with u = w r + b: u is `target` as long as the motor can, and between low and high whatever that takes.
inline Real answer_axis(const AxisBounds& axis, Real w, Real b) {
    if (!(w > 0)) return 0;
    const Real motor = axis.most > 0 ? std::clamp((axis.target - b) / w, -axis.most, axis.most) : 0;
    const Real u = b + w * motor;
    if (u < axis.low) return (axis.low - b) / w;
    if (u > axis.high) return (axis.high - b) / w;
    return motor;
}

/// Three rows with their block of W, in their own frame.
struct JointLaw {
    bool axis_free;  // the third row is an axis, else locked as the others are
    AxisBounds axis{};
    Mat3 block;          // of W
    Mat3 inverse;        // of the locked part of it
    Real axis_mobility;  // of the axis with the locked rows in force

    void prepare(const Mat3& of, bool with_axis);

    /// r with u = W r + b, u zero in the locked rows.
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

    /// How far r is from what u asks for, with a number in the place of W (docs/methods/errors.md 1).
    Vec3 natural_map(const Vec3& r, const Vec3& u, Real mobility) const {
        Vec3 residual = u / mobility;
        if (axis_free) residual.z() = r.z() - answer_axis(axis, mobility, u.z() - mobility * r.z());
        return residual;
    }
};

}  // namespace skerry
