// Encodes a value in eleven bits and a sign, with a finer resolution for small values.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "components/types.h"

namespace skerry {

/// Scale for encoding values as integers: code = 2047 sqrt(value / top). `top` is a power of four that is at least as
/// large as every value so far. If it grows by a factor of four, all codes halve, except for rounding to integers.
///
/// The rounding error of a value is sqrt(value top) / 2047, that is 0.5 % for value = top / 100 and 5 % for
/// value = top / 10000. A single large value therefore costs small values little accuracy.
class ValueScale {
public:
    static constexpr int last = 2047;
    /// Range of the exponent. A new scale starts with the smallest exponent. The value 4^highest is still finite.
    static constexpr int lowest = -255, highest = 511;

    void widen(Real value) {
        if (!std::isfinite(value)) return;
        while (exponent_ < highest && value > top()) ++exponent_;
    }
    /// Exponent e of top = 4^e. It never decreases.
    int exponent() const { return exponent_; }
    Real top() const { return std::ldexp(1.0, 2 * exponent_); }
    /// Returns the code, with the sign of the value. The code of NaN is 0, and values above `top` get the largest code.
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

/// Converts a code of a scale with `exponent_prev` to the code of the same value with the larger `exponent`. Each
/// increase of the exponent by one halves the code.
inline int shifted(int code, int exponent_prev, int exponent) {
    // Larger shifts of an int than 31 are undefined.
    return code >> std::min(exponent - exponent_prev, 31);
}

}  // namespace skerry
