// A box of tetrahedra of which some are nearly flat.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "skerry/mesh.h"

namespace skerry::test {

/// A box of cubic cells, each the mirror image of its neighbours. Unlike in mesh::box, a node can move to the middle of
/// an opposite face without inverting another tetrahedron.
inline Mesh mirrored_box(Real size, int cells) {
    Mesh mesh;
    for (int z = 0; z <= cells; ++z)
        for (int y = 0; y <= cells; ++y)
            for (int x = 0; x <= cells; ++x) mesh.nodes.push_back(size * (Vec3(x, y, z) / cells - Vec3::Constant(0.5)));
    const auto node_at = [&](const std::array<int, 3>& p) {
        return static_cast<Index>((p[2] * (cells + 1) + p[1]) * (cells + 1) + p[0]);
    };
    constexpr std::array<std::array<std::size_t, 3>, 6> axis_orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (int cell = 0; cell < cells * cells * cells; ++cell) {
        const std::array<int, 3> at{cell % cells, cell / cells % cells, cell / (cells * cells)};
        for (const auto& order : axis_orders) {
            std::array<int, 3> corner{at[0] + at[0] % 2, at[1] + at[1] % 2, at[2] + at[2] % 2};
            std::array<Index, 4> t{node_at(corner)};
            for (std::size_t i = 0; i < 3; ++i) {
                corner[order[i]] += at[order[i]] % 2 == 0 ? 1 : -1;
                t[i + 1] = node_at(corner);
            }
            const auto from_first = [&](std::size_t k) -> Vec3 {
                return mesh.nodes[static_cast<std::size_t>(t[k])] - mesh.nodes[static_cast<std::size_t>(t[0])];
            };
            if (from_first(1).cross(from_first(2)).dot(from_first(3)) < 0) std::swap(t[2], t[3]);
            mesh.tetrahedra.push_back(t);
        }
    }
    return mesh;
}

/// A mirrored_box with `share` of its tetrahedra made flat. An interior node moves close to the middle of the opposite
/// face of one of its tetrahedra, to `flatness` of the altitude. Faces lie in common planes, so that four to eight
/// tetrahedra become flat at once. No two nodes of a tetrahedron are moved. There are fewer slivers than requested if
/// there is no room.
inline Mesh sliver_box(Real size, int cells, Real share, Real flatness, std::uint64_t seed = 1) {
    Mesh mesh = mirrored_box(size, cells);
    std::vector<std::vector<std::size_t>> around(mesh.nodes.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (Index n : mesh.tetrahedra[t]) around[static_cast<std::size_t>(n)].push_back(t);
    const auto node = [&](Index n) -> Vec3& { return mesh.nodes[static_cast<std::size_t>(n)]; };
    const auto six_volumes = [&](std::size_t t) {
        const auto& c = mesh.tetrahedra[t];
        return (node(c[1]) - node(c[0])).cross(node(c[2]) - node(c[0])).dot(node(c[3]) - node(c[0]));
    };
    const Real regular = std::pow(size / cells, 3);  // six volumes of each tetrahedron before any node moves
    std::vector<bool> used(mesh.nodes.size(), false);
    std::mt19937_64 random(seed);
    const auto target_count = static_cast<std::size_t>(share * static_cast<Real>(mesh.tetrahedra.size()) + 0.5);
    std::size_t made = 0;
    for (std::size_t tries = 0; tries < 50 * mesh.tetrahedra.size() && made < target_count; ++tries) {
        const auto& corners = mesh.tetrahedra[random() % mesh.tetrahedra.size()];
        const std::size_t moved = random() % 4;
        const Index n = corners[moved];
        const Vec3 old = node(n);
        const bool inside = old.cwiseAbs().maxCoeff() < size / 2 * (1 - 1e-9);
        bool free = inside;
        for (std::size_t t : around[static_cast<std::size_t>(n)])
            for (Index other : mesh.tetrahedra[t]) free = free && !used[static_cast<std::size_t>(other)];
        if (!free) continue;
        const Vec3 &a = node(corners[(moved + 1) % 4]), &b = node(corners[(moved + 2) % 4]),
                   &c = node(corners[(moved + 3) % 4]);
        const Vec3 normal = (b - a).cross(c - a).normalized();
        node(n) = (a + b + c) / 3 + flatness * normal.dot(old - a) * normal;
        std::size_t flat = 0;
        for (std::size_t t : around[static_cast<std::size_t>(n)]) {
            free = free && six_volumes(t) > 0.5 * flatness * regular;
            flat += six_volumes(t) < 2 * flatness * regular;
        }
        if (!free) {
            node(n) = old;
            continue;
        }
        made += flat;
        for (std::size_t t : around[static_cast<std::size_t>(n)])
            for (Index other : mesh.tetrahedra[t]) used[static_cast<std::size_t>(other)] = true;
    }
    return mesh;
}

}  // namespace skerry::test
