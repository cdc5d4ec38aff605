// Number and vector types of the engine. This header is installed with the library; cmake/install.cmake lists all such
// headers of components/.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>

namespace skerry {

using Real = double;                                                     // number type of all quantities
inline constexpr Real infinity = std::numeric_limits<Real>::infinity();  // as a limit it means: no limit
using Vec3 = Eigen::Matrix<Real, 3, 1>;  // 24 bytes, no padding: a Column<Vec3> is a flat array of reals
using Mat3 = Eigen::Matrix<Real, 3, 3>;  // rotation, inertia, stress or strain

using Index = std::int32_t;            // index of a row of a table
inline constexpr Index no_index = -1;  // no row

}  // namespace skerry
