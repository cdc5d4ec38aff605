#include "systems/dynamics/rigid/rigid_motion.h"

#include "systems/geometry/rotation.h"
#include "systems/geometry/symmetric_eigen.h"

namespace skerry {

PrincipalInertia::PrincipalInertia(const Mat3& inertia) {
    const SymmetricEigen principal = symmetric_eigen(inertia);
    moments = principal.values;
    axes = principal.vectors;
    if (axes.determinant() < 0) axes.col(2) *= -1;
}

Mat3 turn_of_step(const Mat3& rotation, const Vec3& moments, const Vec3& angular_momentum, const Vec3& push_spin,
                  Real h) {
    return without_strain(rotation_matrix(h * push_spin) * turned_freely(rotation, moments, angular_momentum, h));
}

Mat3 without_strain(const Mat3& rotation) {
    // One Newton step to the nearest rotation. It squares the deviation of the matrix from a rotation.
    return 0.5 * rotation * (3 * Mat3::Identity() - rotation.transpose() * rotation);
}

}  // namespace skerry
