// The frequency of a sampled oscillation.
#pragma once

#include <cmath>
#include <span>

#include "components/types.h"

namespace skerry::test {

/// Angular frequency of an oscillation about `mean`, sampled every h seconds by symplectic Euler, without the error of
/// the step [rad/s]. Solves x_n+1 + x_n-1 = (2 - (omega h)^2) x_n for omega by least squares.
inline Real angular_frequency(std::span<const Real> sample, Real h, Real mean = 0) {
    Real product = 0, square = 0;
    for (std::size_t n = 1; n + 1 < sample.size(); ++n) {
        const Real x = sample[n] - mean;
        product += x * (sample[n + 1] + sample[n - 1] - 2 * mean);
        square += x * x;
    }
    return std::sqrt(2 - product / square) / h;
}

}  // namespace skerry::test
