// Rotations as vectors: axis times angle.
#pragma once

#include <Eigen/Geometry>

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

}  // namespace skerry
