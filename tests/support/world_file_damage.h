// Saved worlds with wrong values: whole files with a right checksum, as damage on a disk would not make them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "components/types.h"
#include "engine/world/save/saved_file.h"

namespace skerry::test {

/// Location of the values of an array in a file.
struct ValuesInFile {
    std::string path;
    std::size_t begin, bytes, number_bytes;
    bool reals;
};

/// Locations of the values of all arrays that have any, in the order of the names.
inline std::vector<ValuesInFile> values_in(std::span<const std::byte> file) {
    std::vector<ValuesInFile> found;
    const SavedFile saved("file", file);
    for (const auto& [name, array] : saved.arrays())
        if (!array.bytes.empty())
            found.push_back({name, static_cast<std::size_t>(array.bytes.data() - file.data()), array.bytes.size(),
                             bytes_of(array.number),
                             array.number == NumberType::real || array.number == NumberType::single});
    return found;
}

/// Overwrites one number of an array: `offset` selects the number, `choice` the new value.
inline void change_value(const ValuesInFile& values, std::size_t offset, unsigned choice, std::span<std::byte> file) {
    constexpr Real infinite = std::numeric_limits<Real>::infinity();
    constexpr Real none = std::numeric_limits<Real>::quiet_NaN();
    constexpr std::array<Real, 10> reals{0, -1, 1, 1e300, -1e300, 1e-300, 5e-324, none, infinite, 0.5};
    constexpr std::array<std::uint64_t, 10> integers{0,       1, 2, 3, 7, 255, 65535, 0x7fffffff, ~std::uint64_t{0},
                                                     1u << 20};
    const std::size_t count = values.bytes / values.number_bytes;
    std::byte* const at = file.data() + values.begin + offset % count * values.number_bytes;
    const Real real = reals[choice % reals.size()];
    const auto single = static_cast<float>(real);
    if (values.reals && values.number_bytes == sizeof single)
        std::memcpy(at, &single, sizeof single);
    else if (values.reals)
        std::memcpy(at, &real, sizeof real);
    else
        std::memcpy(at, &integers[choice % integers.size()], values.number_bytes);
}

}  // namespace skerry::test
