// A box of tetrahedra with randomly moved nodes: the mesh of the elastic tests.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "components/types.h"

namespace skerry::test {

struct TetMesh {
    std::vector<Vec3> nodes;                       // [m]
    std::vector<std::array<Index, 4>> tetrahedra;  // positive volumes
};

inline Real volume_of(const TetMesh& mesh, const std::array<Index, 4>& tet) {
    const auto at = [&](std::size_t a) -> const Vec3& { return mesh.nodes[static_cast<std::size_t>(tet[a])]; };
    return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6;
}

/// A uniform number in [-1, 1], equal on every machine (std::uniform_real_distribution is not).
inline Real uniform(std::mt19937_64& random) {
    return static_cast<Real>(random() >> 11) * 0x1p-52 - 1;
}

inline Vec3 random_vector(std::mt19937_64& random) {
    const Real x = uniform(random), y = uniform(random), z = uniform(random);
    return {x, y, z};
}

/// A box of cells of edge h, six tetrahedra each (Kuhn), with the lower corner at the origin. Every node is moved by up
/// to jitter h in each direction, less where a tetrahedron would keep less than `flattest` of its volume. jitter 0.3
/// with flattest 0.01 gives slivers.
inline TetMesh jittered_box(const std::array<Index, 3>& cells, Real h, Real jitter, std::uint64_t seed,
                            Real flattest = 0.05) {
    const auto row = [&](Index i, Index j, Index k) { return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i; };
    TetMesh mesh;
    for (Index k = 0; k <= cells[2]; ++k)
        for (Index j = 0; j <= cells[1]; ++j)
            for (Index i = 0; i <= cells[0]; ++i) mesh.nodes.push_back(h * Vec3(i, j, k));
    constexpr std::array<std::array<int, 3>, 6> path{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (Index k = 0; k < cells[2]; ++k)
        for (Index j = 0; j < cells[1]; ++j)
            for (Index i = 0; i < cells[0]; ++i)
                for (std::size_t p = 0; p < 6; ++p) {
                    std::array<Index, 3> at{i, j, k};
                    std::array<Index, 4> tet{row(i, j, k)};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++at[static_cast<std::size_t>(path[p][step])];
                        tet[step + 1] = row(at[0], at[1], at[2]);
                    }
                    if (p >= 3) std::swap(tet[1], tet[2]);  // odd paths are mirrored
                    mesh.tetrahedra.push_back(tet);
                }

    std::mt19937_64 random(seed);
    const TetMesh even = mesh;
    for (Vec3& x : mesh.nodes) x += jitter * h * random_vector(random);
    for (bool moved = jitter > 0; moved;) {
        moved = false;
        for (const auto& tet : mesh.tetrahedra) {
            if (volume_of(mesh, tet) >= flattest * h * h * h / 6) continue;
            moved = true;
            for (Index n : tet) {
                const std::size_t node = static_cast<std::size_t>(n);
                mesh.nodes[node] = 0.75 * mesh.nodes[node] + 0.25 * even.nodes[node];
            }
        }
    }
    return mesh;
}

}  // namespace skerry::test
