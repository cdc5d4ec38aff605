// Rotation vectors: direction of the axis times rotation angle.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "components/types.h"

namespace skerry {

/// Matrix of the rotation about the direction of `rotation` by the angle |rotation| [rad].
inline Mat3 rotation_matrix(const Vec3& rotation) {
    const Real angle = rotation.norm();
    if (angle == 0) return Mat3::Identity();
    return Eigen::AngleAxis<Real>(angle, rotation / angle).toRotationMatrix();
}

/// Rotation vector of a rotation matrix: unit axis times angle, with an angle of at most pi [rad].
inline Vec3 rotation_vector(const Mat3& rotation) {
    const Eigen::AngleAxis<Real> turn(rotation);
    return turn.axis() * turn.angle();
}

/// Returns the rotation vector nearest to `to` among those that describe the same rotation as `rotation`. These vectors
/// differ by full revolutions about the axis of the rotation.
inline Vec3 nearest_turn(const Vec3& rotation, const Vec3& to) {
    constexpr Real turn = 2 * std::numbers::pi;
    const Real angle = rotation.norm();
    if (angle == 0) {
        // The identity is described by the zero vector, and by full revolutions about any axis. The nearest of these
        // vectors to `to` has the direction of `to`.
        const Real length = to.norm();
        return length > 0 ? Vec3(turn * std::round(length / turn) / length * to) : rotation;
    }
    const Vec3 axis = rotation / angle;
    return (angle + turn * std::round((axis.dot(to) - angle) / turn)) * axis;
}

}  // namespace skerry
