// Derivative of the stress of a material law by the deformation gradient, by central differences.
#pragma once

#include "systems/material/material_law.h"

namespace skerry::test {

using Matrix9 = Eigen::Matrix<Real, 9, 9>;
using Vector9 = Eigen::Matrix<Real, 9, 1>;

/// Column i is the change of the stress by entry i of F, both in the order of the columns of F [Pa].
inline Matrix9 slope_of_stress(const MaterialConstants& material, const Mat3& F) {
    Matrix9 H;
    constexpr Real step = 1e-6;
    for (Index i = 0; i < 9; ++i) {
        Mat3 up = F, down = F;
        up.data()[i] += step;
        down.data()[i] -= step;
        const Mat3 column = (stress(material, up) - stress(material, down)) / (2 * step);
        H.col(i) = Eigen::Map<const Vector9>(column.data());
    }
    return H;
}

}  // namespace skerry::test
