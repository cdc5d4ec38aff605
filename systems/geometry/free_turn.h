// Torque-free rotation of a rigid body (docs/methods/rigid_bodies.md 2).
#pragma once

#include <cmath>

#include "components/types.h"

namespace skerry {

/// Rotates the body about one of its principal axes, at the rate given by the angular momentum about that axis. The
/// rotation conserves this component and, in the world frame, the whole angular momentum.
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

/// Rotation (principal frame to world) after `seconds` without torque. `moments`: moments of inertia about the
/// principal axes [kg m^2]. The motion is a symmetric composition of five rotations about these axes. Each is the exact
/// motion of one part of the kinetic energy (Dullweber, Leimkuhler, McLachlan 1997). The method is symplectic,
/// reversible and of order 2, and it conserves the angular momentum.
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
