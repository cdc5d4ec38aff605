// The free motion of a rigid body (docs/methods/rigid_bodies.md 2).
#pragma once

#include "components/types.h"

namespace skerry {

/// Angular velocity, rad/s, world. `rotation`: principal frame to world; `moments`: kg m^2.
inline Vec3 spin_of(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum) {
    const Vec3 own = rotation.transpose() * angular_momentum;
    return rotation * own.cwiseQuotient(moments);
}

/// 1/(kg m^2), world.
inline Mat3 inverse_inertia_of(const Mat3& rotation, const Vec3& moments) {
    return rotation * moments.cwiseInverse().asDiagonal() * rotation.transpose();
}

/// The rotation after `seconds` without a moment: five turns about principal axes, each the exact motion of a part of
/// the kinetic energy, one behind the other forth and back (Dullweber, Leimkuhler, McLachlan 1997). Symplectic,
/// reversible, of order 2; the angular momentum stays as it is.
Mat3 turned_freely(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum, Real seconds);

/// The nearest rotation to one that rounding has changed a little.
Mat3 without_strain(const Mat3& rotation);

}  // namespace skerry
