// Numbers packed into few bytes.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "components/types.h"

namespace skerry {

static_assert(std::endian::native == std::endian::little, "the page reads packed frames in place");

template <class T>
void put(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline void put_floats(std::string& out, const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) put(out, static_cast<float>(v[axis]));
}

/// Blocks start at multiples of 4, so that a reader can look at them in place.
inline void fill_up(std::string& out) {
    out.append((4 - out.size() % 4) % 4, '\0');
}

/// value in [0, top] as a fraction of the largest code. What is not finite or outside goes to the nearer end, nan to 0.
template <class Code>
Code code_of(Real value, Real top) {
    constexpr Real last = std::numeric_limits<Code>::max();
    const Real fraction = top > 0 ? value / top : 0;
    return std::isnan(fraction) ? Code{0} : static_cast<Code>(std::lround(std::clamp<Real>(fraction, 0, 1) * last));
}

/// Points within their common box: f32 lower[3], f32 extent[3], u16 code[3 n]. 1/65535 of the extent is 15 micrometres
/// in a metre.
void put_points(std::string& out, std::span<const Vec3> points);

/// The numbers as they are in memory, in base64 (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace skerry
