#include "tests/support/dense_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace skerry::test {

SymmetricModes symmetric_modes(const Eigen::MatrixXd& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& symmetric) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M) {
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, M, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    return A.ldlt().solve(B);
}

Eigen::MatrixXd solve_dense(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    return A.partialPivLu().solve(B);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A) {
    return solve_dense(A, Eigen::MatrixXd::Identity(A.rows(), A.cols()));
}

Mat3 rotation_between(const Vec3& from, const Vec3& to) {
    return Eigen::Quaternion<Real>::FromTwoVectors(from, to).toRotationMatrix();
}

Mat3 orthogonal_factor(const Mat3& A) {
    const Eigen::JacobiSVD<Mat3> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return svd.matrixU() * svd.matrixV().transpose();
}

}  // namespace skerry::test
