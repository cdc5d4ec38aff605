// Torque-free rotation of a rigid body (docs/methods/rigid_bodies.md 2).
#pragma once

#include <cmath>

#include "components/types.h"

namespace skerry {

/// Rotates a body for the time `seconds` about one of its principal axes, with the angular velocity
/// own_momentum[axis] / moments[axis]. `rotation`: principal frame to world. `own_momentum`: angular momentum in the
/// principal frame. It rotates by the opposite angle in this frame, so that the angular momentum in the world is
/// conserved.
inline void turn_about(Eigen::Index axis, const Vec3& moments, Real seconds, Mat3& rotation, Vec3& own_momentum) {
    const Real angle = seconds * own_momentum[axis] / moments[axis];
    if (angle == 0) return;
    const Real cosine = std::cos(angle), sine = std::sin(angle);
    const Eigen::Index first = (axis + 1) % 3, second = (axis + 2) % 3;
    const Vec3 a = rotation.col(first), b = rotation.col(second);
    rotation.col(first) = cosine * a + sine * b;
    rotation.col(second) = cosine * b - sine * a;
    const Real p = own_momentum[first], q = own_momentum[second];
    own_momentum[first] = cosine * p + sine * q;
    own_momentum[second] = cosine * q - sine * p;
}

/// Orientation (principal frame to world) of a body after a rotation without torque for `seconds`. `moments`: moments
/// of inertia about the principal axes [kg m^2].
///
/// The motion is approximated by five rotations about principal axes, in symmetric order (Dullweber, Leimkuhler,
/// McLachlan 1997). Each is the exact motion for one of the three terms of the kinetic energy. The method is
/// symplectic, time-reversible and of order 2, and it conserves the angular momentum.
inline Mat3 turned_freely(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum, Real seconds) {
    Mat3 turned = rotation;
    Vec3 own = rotation.transpose() * angular_momentum;
    turn_about(0, moments, seconds / 2, turned, own);
    turn_about(1, moments, seconds / 2, turned, own);
    turn_about(2, moments, seconds, turned, own);
    turn_about(1, moments, seconds / 2, turned, own);
    turn_about(0, moments, seconds / 2, turned, own);
    return turned;
}

}  // namespace skerry
