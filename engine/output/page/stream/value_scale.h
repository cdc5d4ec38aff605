// Encodes values in eleven bits, with a finer resolution for small values.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "components/types.h"

namespace skerry {

/// Codes are square roots of values: code = 2047 sqrt(value / top). `top` is a power of four, not below any value so
/// far. The error of a value is sqrt(value top) / 2047: 0.5 % at a hundredth of the top, 5 % at a ten-thousandth, so
/// one impact costs small values little accuracy. If the top grows by a factor of four, codes halve: changes between
/// frames stay small integers.
class ValueScale {
public:
    static constexpr int last = 2047;
    /// Exponents of a new scale and of the widest one. 4^highest is finite.
    static constexpr int lowest = -255, highest = 511;

    void widen(Real value) {
        if (!std::isfinite(value)) return;
        while (exponent_ < highest && value > top()) ++exponent_;
    }
    /// exponent of four
    int exponent() const { return exponent_; }
    Real top() const { return std::ldexp(1.0, 2 * exponent_); }
    /// Code with the sign of the value. NaN becomes 0; values above the top get the last code.
    int code(Real value) const {
        if (std::isnan(value)) return 0;
        const Real root = std::ldexp(std::sqrt(std::abs(value)), -exponent_);
        const int size = static_cast<int>(std::lround(last * std::min<Real>(root, 1)));
        return value < 0 ? -size : size;
    }
    Real value(int code) const {
        const Real root = std::ldexp(static_cast<Real>(code) / last, exponent_);
        return code < 0 ? -root * root : root * root;
    }

private:
    int exponent_ = lowest;
};

/// Converts a code of an earlier scale to a later one.
inline int shifted(int code, int exponent_prev, int exponent) {
    return code >> std::min(exponent - exponent_prev, 31);
}

}  // namespace skerry
