// The free motion of a rigid body (docs/methods/rigid_bodies.md 2).
#pragma once

#include "components/types.h"
#include "systems/geometry/free_turn.h"

namespace skerry {

/// Angular velocity in the world [rad/s]. `rotation`: principal frame to world; `moments`: principal moments [kg m^2].
inline Vec3 spin_of(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum) {
    const Vec3 own = rotation.transpose() * angular_momentum;
    return rotation * own.cwiseQuotient(moments);
}

/// Inverse inertia in the world [1/(kg m^2)].
inline Mat3 inverse_inertia_of(const Mat3& rotation, const Vec3& moments) {
    return rotation * moments.cwiseInverse().asDiagonal() * rotation.transpose();
}

/// Principal moments and axes of a body with this inertia about its centre [kg m^2].
struct PrincipalInertia {
    Vec3 moments;  // [kg m^2]
    Mat3 axes;     // principal frame to the frame of the inertia

    explicit PrincipalInertia(const Mat3& inertia);
};

/// Rotation (principal frame to world) at the end of a step, after free rotation and the push of contacts, `push_spin`
/// [rad/s].
Mat3 turn_of_step(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum, const Vec3& push_spin,
                  Real h);

/// Nearest rotation to one that has a small error of rounding.
Mat3 without_strain(const Mat3& rotation);

}  // namespace skerry
