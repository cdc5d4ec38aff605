// Logarithm and exponential function for powers of positive numbers, lane by lane. They use only the four basic
// operations, which IEEE 754 rounds correctly. So results have equal bits for every number of lanes and on every
// machine.
#pragma once

#include <bit>
#include <cstdint>

#include "systems/material/lane_math.h"

namespace skerry {

namespace lane_power_detail {

/// Unsigned integers with as many lanes as T.
template <class T>
struct BitsOf {
    typedef std::uint64_t type __attribute__((vector_size(sizeof(T))));
};
template <>
struct BitsOf<Real> {
    using type = std::uint64_t;
};
template <class T>
using Bits = typename BitsOf<T>::type;

// If an integer between -2^51 and 2^51 is added to this number, the lowest bits of the sum are those of the integer in
// two's complement. Adding any real number of this range rounds it to an integer.
inline constexpr Real integer_shift = 0x1.8p52;
inline constexpr int fraction_bits = 52;
inline constexpr Real ln2_high = 0x1.62e42fefa0000p-1, ln2_low = 0x1.cf79abc9e3b3ap-40;

}  // namespace lane_power_detail

/// Natural logarithm of normal numbers above 0. The error is a few units in the last place.
template <class T>
T log_of(const T& x) {
    using namespace lane_power_detail;
    constexpr std::uint64_t root_half = std::bit_cast<std::uint64_t>(0x1.6a09e667f3bcdp-1), exponent_bias = 1023;
    // x = 2^(power - bias) m with m between sqrt(1/2) and sqrt(2).
    const Bits<T> bits = std::bit_cast<Bits<T>>(x);
    const Bits<T> power = (bits - root_half + (exponent_bias << fraction_bits)) >> fraction_bits;
    const T m = std::bit_cast<T>(bits - ((power - exponent_bias) << fraction_bits));
    const T exponent =
        std::bit_cast<T>(power + std::bit_cast<std::uint64_t>(integer_shift)) - (integer_shift + exponent_bias);
    // log m = 2 artanh(s). The first term left out is s^23 2/23, below 2e-19.
    const T s = (m - 1.0) / (m + 1.0), square = s * s;
    T sum = T{} + 1.0 / 21;
    for (const Real divisor : {19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0}) sum = sum * square + 1.0 / divisor;
    return exponent * ln2_high + (exponent * ln2_low + (2.0 * s + 2.0 * s * square * sum));
}

/// Exponential function. Arguments are limited to +-700, so that the result is a normal number.
template <class T>
T exp_of(const T& x) {
    using namespace lane_power_detail;
    constexpr Real limit = 700, one_over_ln2 = 1.4426950408889634;
    constexpr std::uint64_t one = std::bit_cast<std::uint64_t>(1.0);
    const T upper = x < limit ? x : T{} + limit, y = upper > -limit ? upper : T{} - limit;
    const T shifted = y * one_over_ln2 + integer_shift, n = shifted - integer_shift;
    const T r = (y - n * ln2_high) - n * ln2_low;  // |r| <= ln 2 / 2
    // Taylor series. The first term left out is r^14/14!, below 5e-18.
    T sum = T{} + 1.0 / 6227020800.0;
    for (const Real factorial :
         {479001600.0, 39916800.0, 3628800.0, 362880.0, 40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0, 2.0})
        sum = sum * r + 1.0 / factorial;
    const T fraction = 1.0 + (r + r * r * sum);
    const T scale = std::bit_cast<T>((std::bit_cast<Bits<T>>(shifted) << fraction_bits) + one);
    return fraction * scale;
}

}  // namespace skerry
