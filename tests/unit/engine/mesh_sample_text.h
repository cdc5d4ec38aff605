// Numbers in sample files.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <sstream>
#include <string>

#include "skerry/mesh.h"

namespace skerry::test {

/// Appends the bytes of a number, in the other byte order if `swap` is set.
template <class T>
void put(std::string& file, T value, bool swap) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (swap) std::reverse(bytes, bytes + sizeof(T));
    file.append(bytes, sizeof(T));
}

/// All digits of a position.
inline std::string text(const Vec3& x) {
    std::ostringstream out;
    out.precision(17);
    out << x[0] << ' ' << x[1] << ' ' << x[2];
    return out.str();
}

/// Node numbers, each after a space.
template <std::size_t N>
std::string text(const std::array<Index, N>& nodes, int first_number) {
    std::string line;
    for (const Index n : nodes) line += ' ' + std::to_string(n + first_number);
    return line;
}

/// Label of a tetrahedron, 1 without labels.
inline int label_of(const Mesh& mesh, std::size_t tetrahedron) {
    return mesh.label.empty() ? 1 : mesh.label[tetrahedron];
}

}  // namespace skerry::test
