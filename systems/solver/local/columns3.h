// A 3x3 matrix stored as columns that are padded to vector registers.
#pragma once

#include <array>

#include "components/types.h"
#include "systems/solver/local/friction_law.h"

namespace skerry {

using Columns3 = std::array<Vec4, 3>;

inline Columns3 columns_of(const Mat3& matrix) {
    return {padded(matrix.col(0)), padded(matrix.col(1)), padded(matrix.col(2))};
}
inline Mat3 matrix_of(const Columns3& columns) {
    Mat3 matrix;
    for (int k = 0; k < 3; ++k) matrix.col(k) = columns[static_cast<std::size_t>(k)].head<3>();
    return matrix;
}
inline Vec4 times(const Columns3& matrix, const Vec4& vector) {
    return matrix[0] * vector[0] + (matrix[1] * vector[1] + matrix[2] * vector[2]);
}

}  // namespace skerry
