// Values in eleven bits, fine where they are small.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "components/types.h"

namespace skerry {

/// Codes are roots of values: code = 2047 sqrt(value / top), where `top`, a power of four, is not below any value seen
/// so far. So a value is right to sqrt(value top) / 2047: 0.5 % of what is a hundredth of the top, 5 % of what is a ten
/// thousandth. One impact costs what rests little. Wider by a factor of four, codes halve: changes between frames
/// stay small integers.
class ValueScale {
public:
    static constexpr int last = 2047;
    /// Exponents of a new scale and of the widest one: 4^highest is finite.
    static constexpr int lowest = -255, highest = 511;

    void widen(Real value) {
        if (!std::isfinite(value)) return;
        while (exponent_ < highest && value > top()) ++exponent_;
    }
    /// of four
    int exponent() const { return exponent_; }
    Real top() const { return std::ldexp(1.0, 2 * exponent_); }
    /// With the sign of the value. Nan goes to 0, what is above the top to the last code.
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

/// Codes of an earlier scale as they are on a later one.
inline int shifted(int code, int exponent_prev, int exponent) {
    return code >> std::min(exponent - exponent_prev, 31);
}

}  // namespace skerry
