#include "systems/material/tangent.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "systems/geometry/symmetric_eigen.h"

namespace skerry {

Stretches::Stretches(const Mat3& F) {
    // Uses the eigenvalues of F^T F. They take a third of the time of a singular value decomposition (SVD). The SVD is
    // needed if a stretch is so small that its square is lost in rounding.
    constexpr Real flat = 1e-4;  // least ratio of the smallest to the largest squared stretch for the use of F^T F
    const SymmetricEigen squares = symmetric_eigen(F.transpose() * F);
    const Vec3& squared = squares.values;
    if (squared[0] > flat * squared[2]) {
        right = squares.vectors;
        if (right.determinant() < 0) right.col(0) *= -1;
        stretch = squared.cwiseSqrt();
        if (F.determinant() < 0) stretch[0] *= -1;
        left = F * right * stretch.cwiseInverse().asDiagonal();
        return;
    }
    const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    left = svd.matrixU();
    right = svd.matrixV();
    stretch = svd.singularValues();
    if (left.determinant() < 0) {
        left.col(2) *= -1;
        stretch[2] *= -1;
    }
    if (right.determinant() < 0) {
        right.col(2) *= -1;
        stretch[2] *= -1;
    }
}

Tangent without_softening(const Stretches& frames, const Mat3& normal, const Vec3& flip, const Vec3& twist) {
    Tangent tangent{frames.left, frames.right, normal, flip.cwiseMax(0), twist.cwiseMax(0)};
    if (Eigen::LLT<Mat3>(normal).info() == Eigen::Success) return tangent;
    const SymmetricEigen modes = symmetric_eigen(normal);
    tangent.normal = modes.vectors * modes.values.cwiseMax(0).asDiagonal() * modes.vectors.transpose();
    return tangent;
}

}  // namespace skerry
