// Free motion of a rigid body (docs/methods/rigid_bodies.md 2).
#pragma once

#include "components/types.h"
#include "systems/geometry/free_turn.h"

namespace skerry {

/// Angular velocity of a rigid body in the world frame [rad/s]. `rotation`: from the principal frame to the world;
/// `moments`: principal moments of inertia [kg m^2].
inline Vec3 spin_of(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum) {
    const Vec3 own = rotation.transpose() * angular_momentum;
    return rotation * own.cwiseQuotient(moments);
}

/// Inverse inertia tensor of a rigid body in the world frame [1/(kg m^2)].
inline Mat3 inverse_inertia_of(const Mat3& rotation, const Vec3& moments) {
    return rotation * moments.cwiseInverse().asDiagonal() * rotation.transpose();
}

/// Principal moments and axes of a body with a given inertia tensor about its centre of mass [kg m^2].
struct PrincipalInertia {
    Vec3 moments;  // [kg m^2]
    Mat3 axes;     // rotation from the principal frame to the frame of the inertia tensor

    explicit PrincipalInertia(const Mat3& inertia);
};

/// Rotation from the principal frame to the world at the end of a step of length `h` [s]. `rotation` is its value at
/// the start. The body rotates freely, and in addition at the angular velocity `push_spin` by which contacts push
/// bodies out of overlaps [rad/s].
Mat3 turn_of_step(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum, const Vec3& push_spin,
                  Real h);

/// Rotation nearest to a rotation matrix that has small rounding errors.
Mat3 without_strain(const Mat3& rotation);

}  // namespace skerry
