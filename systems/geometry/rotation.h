// Rotations as vectors: axis times angle.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "components/types.h"

namespace skerry {

/// The rotation about `rotation` by its length in radians.
inline Mat3 rotation_matrix(const Vec3& rotation) {
    const Real angle = rotation.norm();
    if (angle == 0) return Mat3::Identity();
    return Eigen::AngleAxis<Real>(angle, rotation / angle).toRotationMatrix();
}

/// Axis times angle (at most pi) of a rotation matrix.
inline Vec3 rotation_vector(const Mat3& rotation) {
    const Eigen::AngleAxis<Real> turn(rotation);
    return turn.axis() * turn.angle();
}

/// Of the vectors of a rotation, whole turns apart, the one nearest to another.
inline Vec3 nearest_turn(const Vec3& rotation, const Vec3& to) {
    constexpr Real turn = 2 * std::numbers::pi;
    const Real angle = rotation.norm();
    if (angle == 0) {
        const Real length = to.norm();  // no turn, or whole ones about the other's axis
        return length > 0 ? Vec3(turn * std::round(length / turn) / length * to) : rotation;
    }
    const Vec3 axis = rotation / angle;
    return (angle + turn * std::round((axis.dot(to) - angle) / turn)) * axis;
}

}  // namespace skerry
