// Eigenvalues and eigenvectors of symmetric 3x3 matrices. Callers use these functions in place of Eigen's class,
// because symmetric_eigen.cpp is compiled with flags that make the results independent of the instruction set.
#pragma once

#include "components/types.h"

namespace skerry {

/// Eigenvalues in ascending order, and the unit eigenvectors as columns in the same order.
struct SymmetricEigen {
    Vec3 values;
    Mat3 vectors;
};

/// Eigenvalues and eigenvectors of a symmetric matrix. Only its lower triangle is read.
SymmetricEigen symmetric_eigen(const Mat3& matrix);

/// Eigenvalues of a symmetric matrix in ascending order. Only its lower triangle is read.
Vec3 symmetric_eigenvalues(const Mat3& matrix);

}  // namespace skerry
