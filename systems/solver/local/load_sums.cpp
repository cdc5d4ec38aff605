#include "systems/solver/local/load_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skerry {

Real error_scale(const LoadSums& sums, Real gravity, Real h, Real tolerance) {
    // Lower bounds of the scale, relative to the weight, to the motion and to rounding errors. Without them the solver
    // would be more accurate than necessary where contacts stop almost no motion.
    constexpr Real weight_part = 1e-3, motion_part = 1e-6, rounding = 8 * std::numeric_limits<Real>::epsilon();
    const Real weight = gravity * h * std::sqrt(sums.inverse_diagonals), motion = std::sqrt(sums.moving);
    return std::max(
        {std::sqrt(sums.squared_residual), weight_part * weight, std::max(motion_part, rounding / tolerance) * motion});
}

}  // namespace skerry
