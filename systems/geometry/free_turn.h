// How a rigid body turns by itself (docs/methods/rigid_bodies.md 2).
#pragma once

#include <cmath>

#include "components/types.h"

namespace skerry {

/// A turn of the body about one of its own axes at the rate that its momentum about it gives: that momentum and, seen
/// from the world, all of it stay.
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

/// The rotation (principal frame to world) after `seconds` without a moment; `moments`: kg m^2, of inertia about the
/// principal axes. Five turns about these, each the exact motion of a part of the kinetic energy, one behind the other
/// forth and back (Dullweber, Leimkuhler, McLachlan 1997). Symplectic, reversible, of order 2; the angular momentum
/// stays as it is.
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
