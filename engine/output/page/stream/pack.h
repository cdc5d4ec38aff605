// Encodes numbers as bytes with variable length, and bytes as base64 text.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "components/types.h"

namespace skerry {

static_assert(std::endian::native == std::endian::little,
              "pages store little-endian numbers, so the machine must be little-endian");

template <class T>
void put(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline void put_floats(std::string& out, const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) put(out, static_cast<float>(v[axis]));
}

/// Writes a count with seven bits per byte, lowest bits first. Every byte but the last has its eighth bit set (LEB128).
inline void put_count(std::string& out, std::uint64_t value) {
    for (; value > 127; value >>= 7) out += static_cast<char>((value & 127) | 128);
    out += static_cast<char>(value);
}

/// Maps the integers 0, -1, 1, -2, ... to the counts 0, 1, 2, 3, ..., so that small changes of either sign need few
/// bytes.
constexpr std::uint64_t zigzag(std::int64_t value) {
    return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}

inline void put_change(std::string& out, std::int64_t value) {
    put_count(out, zigzag(value));
}

/// Encodes bytes in base64 (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace skerry
