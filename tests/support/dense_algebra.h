// Decompositions of dense matrices. Their templates take long to compile, so they are compiled once. They are
// optimised, because tests decompose matrices of hundreds of rows.
#pragma once

#include <Eigen/Core>

#include "components/types.h"

namespace skerry::test {

struct SymmetricModes {
    Eigen::VectorXd eigenvalues;  // ascending
    Eigen::MatrixXd eigenvectors;
};

SymmetricModes symmetric_modes(const Eigen::MatrixXd& symmetric);
/// Ascending eigenvalues of a symmetric matrix.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& symmetric);
/// Ascending eigenvalues l of K x = l M x for symmetric K and positive definite M.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

/// Solution X of A X = B for symmetric A.
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// Solution X of A X = B.
Eigen::MatrixXd solve_dense(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A);

/// Rotation by the smallest angle that turns the direction `from` into the direction `to`.
Mat3 rotation_between(const Vec3& from, const Vec3& to);
/// Orthogonal factor of the polar decomposition of A.
Mat3 orthogonal_factor(const Mat3& A);

}  // namespace skerry::test
