// Functions that add arrays to VTK files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "engine/output/vtk/vtk_file.h"

namespace skerry {

inline void put_vector(auto& put, const Vec3& v) {
    put(v.x());
    put(v.y());
    put(v.z());
}

/// Writes the six components of a symmetric tensor in VTK's order, which ParaView shows as XX, YY, ZZ, XY, YZ, XZ.
inline void put_symmetric(auto& put, const Mat3& m) {
    for (const auto& [row, column] : {std::pair{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}) put(m(row, column));
}

/// Adds an array with the number value(row), converted to T, for each element of `rows`.
template <class T>
void scalars(VtkFile& file, std::string_view name, auto&& rows, auto&& value) {
    file.array<T>(name, 1, std::size(rows), [&](auto put) {
        for (const auto& row : rows) put(value(row));
    });
}

inline void vectors(VtkFile& file, std::string_view name, auto&& rows, auto&& value) {
    file.array<float>(name, 3, std::size(rows), [&](auto put) {
        for (const auto& row : rows) put_vector(put, value(row));
    });
}

/// Adds the array "offsets" for `count` cells with `nodes` nodes each. The offset of a cell is the index after its last
/// node in the array "connectivity".
inline void offsets(VtkFile& file, std::size_t count, Index nodes) {
    file.array<std::int32_t>("offsets", 1, count, [&](auto put) {
        for (std::size_t cell = 1; cell <= count; ++cell) put(static_cast<Index>(cell) * nodes);
    });
}

inline std::string count_attribute(std::string_view name, std::size_t count) {
    return "NumberOf" + std::string(name) + "=\"" + std::to_string(count) + "\" ";
}

}  // namespace skerry
