#pragma once

#include <cmath>
#include <random>

#include "components/types.h"

namespace skerry {

/// Random numbers and blocks.
struct Draw {
    std::mt19937 random;
    std::normal_distribution<Real> number;

    explicit Draw(unsigned seed) : random(seed) {}
    Real operator()() { return number(random); }
    /// Symmetric positive definite; `spread` is the standard deviation of the logarithm of its column scales.
    Mat3 block(Real spread) {
        Mat3 factor;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) factor(i, j) = (*this)();
        for (int j = 0; j < 3; ++j) factor.col(j) *= std::exp(spread * (*this)());
        return factor * factor.transpose() + 1e-3 * Mat3::Identity();
    }
};

}  // namespace skerry
