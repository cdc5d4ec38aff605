// Mesh of a thick hollow sphere.
#pragma once

#include <catch2/catch.hpp>
#include <map>
#include <numbers>

#include "tests/support/mapped_box.h"

namespace skerry::test {

/// Six boxes of `across` x `across` x `layers` cells, one on each side of a cube, rounded and joined. The thickness of
/// layers grows with their radius. `inner`, `outer`: radii [m]. `across` is even, so that mirrored cells meet with the
/// same diagonals.
inline Mesh hollow_sphere(Real inner, Real outer, int across, int layers) {
    Mesh whole;
    std::map<std::array<long, 3>, Index> known;  // node at each place
    for (int axis = 0; axis < 3; ++axis)
        for (const Real side : {-1.0, 1.0}) {
            Mat3 turn = Mat3::Zero();  // the outward direction is the third column
            turn(axis, 2) = side;
            turn((axis + 1) % 3, 0) = side;
            turn((axis + 2) % 3, 1) = 1;
            const Mesh patch = mapped_box({across, across, layers}, [&](const Vec3& s) {
                const Real quarter = std::numbers::pi / 4;
                const Vec3 on_cube(std::tan(quarter * (2 * s.x() - 1)), std::tan(quarter * (2 * s.y() - 1)), 1);
                return Vec3(turn * on_cube.normalized() * inner * std::pow(outer / inner, s.z()));
            });
            std::vector<Index> row;
            for (const Vec3& x : patch.nodes) {
                const auto [place, fresh] =
                    known.try_emplace({std::lround(x.x() * 1e6), std::lround(x.y() * 1e6), std::lround(x.z() * 1e6)},
                                      static_cast<Index>(whole.nodes.size()));
                if (fresh) whole.nodes.push_back(x);
                row.push_back(place->second);
            }
            for (auto t : patch.tetrahedra) {
                for (Index& n : t) n = row[static_cast<std::size_t>(n)];
                whole.tetrahedra.push_back(t);
            }
        }
    const MeshReport report = inspect(whole);
    REQUIRE(report.closed_manifold);
    REQUIRE(report.components == 1);
    return whole;
}

}  // namespace skerry::test
