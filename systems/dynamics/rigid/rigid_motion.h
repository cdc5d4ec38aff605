// The free motion of a rigid body (docs/methods/rigid_bodies.md 2).
#pragma once

#include "components/types.h"
#include "systems/geometry/free_turn.h"

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

/// Of a body whose inertia about its centre is this, kg m^2.
struct PrincipalInertia {
    Vec3 moments;  // kg m^2
    Mat3 axes;     // principal frame to that of the inertia

    explicit PrincipalInertia(const Mat3& inertia);
};

/// The rotation (principal frame to world) at the end of a step: turned freely, and by what contacts push (rad/s).
Mat3 turn_of_step(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum, const Vec3& push_spin,
                  Real h);

/// The nearest rotation to one that rounding has changed a little.
Mat3 without_strain(const Mat3& rotation);

}  // namespace skerry
