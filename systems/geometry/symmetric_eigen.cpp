#include "systems/geometry/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

namespace skerry {

SymmetricEigen symmetric_eigen(const Mat3& matrix) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(matrix);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

Vec3 symmetric_eigenvalues(const Mat3& matrix) {
    return Eigen::SelfAdjointEigenSolver<Mat3>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace skerry
