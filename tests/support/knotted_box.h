// A box of tetrahedra with knots: places where the mesh is a thousand times finer, by volume, than around them.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/support/jittered_box.h"

namespace skerry::test {

/// A copy of `box` in which each of the tetrahedra `at` is replaced by thirteen: one of `scale` its size about its
/// middle, and twelve that connect it to the faces.
inline TetMesh knotted_box(const TetMesh& box, std::vector<std::size_t> at, Real scale = 0.1) {
    TetMesh mesh = box;
    std::ranges::sort(at, std::greater<>());
    for (const std::size_t t : at) {
        std::array<Index, 4> outer = box.tetrahedra[t];
        mesh.tetrahedra.erase(mesh.tetrahedra.begin() + static_cast<std::ptrdiff_t>(t));
        std::ranges::sort(outer);  // so that neighbouring prisms agree on the diagonals of their sides
        Vec3 middle = Vec3::Zero();
        for (const Index n : outer) middle += box.nodes[static_cast<std::size_t>(n)] / 4;
        std::array<Index, 4> inner{};
        for (std::size_t a = 0; a < 4; ++a) {
            inner[a] = static_cast<Index>(mesh.nodes.size());
            mesh.nodes.push_back(middle + scale * (box.nodes[static_cast<std::size_t>(outer[a])] - middle));
        }
        std::vector<std::array<Index, 4>> made{inner};
        for (std::size_t removed = 0; removed < 4; ++removed) {
            std::vector<Index> low, high;
            for (std::size_t a = 0; a < 4; ++a)
                if (a != removed) low.push_back(outer[a]), high.push_back(inner[a]);
            made.push_back({low[0], low[1], low[2], high[2]});
            made.push_back({low[0], low[1], high[1], high[2]});
            made.push_back({low[0], high[0], high[1], high[2]});
        }
        for (std::array<Index, 4>& corners : made) {
            if (volume_of(mesh, corners) < 0) std::swap(corners[2], corners[3]);
            mesh.tetrahedra.push_back(corners);
        }
    }
    return mesh;
}

}  // namespace skerry::test
