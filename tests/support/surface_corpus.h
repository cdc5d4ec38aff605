// Triangle surfaces with the faults that files of users have.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh/repair/surface_measures.h"
#include "skerry/surface_check.h"

namespace skerry::test {

using mesh::volume_inside;

inline SurfaceMesh moved(SurfaceMesh surface, const Vec3& by) {
    for (Vec3& x : surface.nodes) x += by;
    return surface;
}

inline SurfaceMesh scaled(SurfaceMesh surface, Real by) {
    for (Vec3& x : surface.nodes) x *= by;
    return surface;
}

inline SurfaceMesh turned_inside_out(SurfaceMesh surface) {
    for (std::array<Index, 3>& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
    return surface;
}

/// Two surfaces as one, without common nodes.
inline SurfaceMesh both(SurfaceMesh first, const SurfaceMesh& second) {
    const auto count = static_cast<Index>(first.nodes.size());
    first.nodes.insert(first.nodes.end(), second.nodes.begin(), second.nodes.end());
    for (const auto& [a, b, c] : second.triangles) first.triangles.push_back({a + count, b + count, c + count});
    return first;
}

/// Reverses the order of the nodes and of the triangles.
inline SurfaceMesh renumbered(SurfaceMesh surface) {
    const auto last = static_cast<Index>(surface.nodes.size()) - 1;
    std::ranges::reverse(surface.nodes);
    std::ranges::reverse(surface.triangles);
    for (std::array<Index, 3>& triangle : surface.triangles)
        for (Index& n : triangle) n = last - n;
    return surface;
}

/// Gives each triangle nodes of its own.
inline SurfaceMesh soup_of(const SurfaceMesh& surface) {
    SurfaceMesh soup;
    for (const std::array<Index, 3>& triangle : surface.triangles) {
        const auto first = static_cast<Index>(soup.nodes.size());
        for (const Index n : triangle) soup.nodes.push_back(surface.nodes[static_cast<std::size_t>(n)]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

/// Joins of the edges of a rectangular grid: open, joined to the opposite edge, or joined to it in reverse.
enum class GridEnds { open, joined, reversed };

/// Triangles of a grid with `across` times `along` cells, with the nodes place(u, v) for u and v from 0 to 1. The ends
/// of u are joined as `ends` says, and those of v are joined if `tube`.
inline SurfaceMesh grid_surface(Index across, Index along, GridEnds ends, bool tube,
                                const std::function<Vec3(Real, Real)>& position_at) {
    SurfaceMesh surface;
    const Index columns = ends == GridEnds::open ? across + 1 : across, rows = tube ? along : along + 1;
    for (Index i = 0; i < columns; ++i)
        for (Index j = 0; j < rows; ++j) surface.nodes.push_back(position_at(Real(i) / across, Real(j) / along));
    const auto node = [&](Index i, Index j) {
        if (i == columns && ends == GridEnds::reversed) j = along - j;
        return i % columns * rows + j % rows;
    };
    for (Index i = 0; i < across; ++i)
        for (Index j = 0; j < along; ++j) {
            surface.triangles.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
            surface.triangles.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
        }
    return surface;
}

/// A ring along the closed curve centre(u), u from 0 to 1, with a circular cross-section. The curve lies in the plane
/// z = 0 except for small heights.
inline SurfaceMesh ring_surface(Index around, Index across, Real radius, const std::function<Vec3(Real)>& centre) {
    return grid_surface(around, across, GridEnds::joined, true, [&](Real u, Real v) {
        constexpr Real near = 1e-4, turn = 2 * std::numbers::pi;
        const Vec3 along = (centre(u + near) - centre(u - near)).normalized();
        const Vec3 side = along.cross(Vec3::UnitZ()).normalized(), up = side.cross(along);
        return Vec3(centre(u) + radius * (std::cos(turn * v) * side + std::sin(turn * v) * up));
    });
}

/// A torus with 2 * around * across triangles.
inline SurfaceMesh torus_surface(Index around, Index across, Real radius = 1, Real tube = 0.3) {
    return ring_surface(around, across, tube, [radius](Real u) {
        const Real angle = 2 * std::numbers::pi * u;
        return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0);
    });
}

inline SurfaceMesh ball_surface(Real radius, int resolution = 8) {
    return mesh::boundary(mesh::ball(radius, resolution));
}

inline SurfaceMesh box_surface(const Vec3& size, const std::array<int, 3>& cells = {2, 2, 2}) {
    return mesh::boundary(mesh::box(size, cells));
}

/// Drops the triangles with a corner at most `radius` from `centre` [m].
inline SurfaceMesh with_hole(SurfaceMesh surface, const Vec3& centre, Real radius) {
    std::erase_if(surface.triangles, [&](const std::array<Index, 3>& triangle) {
        return std::ranges::any_of(
            triangle, [&](Index n) { return (surface.nodes[static_cast<std::size_t>(n)] - centre).norm() <= radius; });
    });
    return surface;
}

struct CorpusSurface {
    std::string name;
    SurfaceMesh surface;
    std::vector<SurfaceFaultKind> faults;  // kinds that a check must find, in ascending order
    // Volume of the solid inside, in which overlapping and repeated parts count once; no value if the surface bounds no
    // solid, or if the volume is not known exactly [m^3]
    std::optional<Real> volume{};
};

/// Small surfaces. Unless the name tells another size, they are about 1 m large.
inline std::vector<CorpusSurface> surface_corpus() {
    using enum SurfaceFaultKind;
    const SurfaceMesh ball = ball_surface(0.5), box = box_surface(Vec3::Ones());
    const Real inside = volume_inside(ball);
    std::vector<CorpusSurface> corpus;
    const auto add = [&](const char* name, SurfaceMesh surface, std::vector<SurfaceFaultKind> faults,
                         std::optional<Real> volume = {}) {
        corpus.push_back({name, std::move(surface), std::move(faults), volume});
    };
    add("ball", ball, {}, inside);
    const SurfaceMesh torus = torus_surface(48, 16);
    add("torus", torus, {}, volume_inside(torus));
    add("two_balls", both(ball, moved(ball, {2, 0, 0})), {}, 2 * inside);
    add("hole", with_hole(ball, {0, 0, 0.5}, 0.05), {holes});
    add("three_holes", with_hole(with_hole(with_hole(ball, {0, 0, 0.5}, 0.2), {0, 0, -0.5}, 0.05), {0.5, 0, 0}, 0.05),
        {holes});
    add("crossing_limb", both(ball, moved(box_surface({1, 0.2, 0.2}, {4, 1, 1}), {0.6, 0.01, 0.02})),
        {shell_crossings, doubled_volumes});
    const auto eight = [](Real u) {
        const Real angle = 2 * std::numbers::pi * u;
        return Vec3(std::sin(angle), std::sin(2 * angle) / 2, 0.05 * std::cos(angle));
    };
    add("self_crossing_tube", ring_surface(64, 12, 0.1, eight), {crossings});

    SurfaceMesh turned = ball;
    for (std::size_t t = 0; t < turned.triangles.size(); t += 7)
        std::swap(turned.triangles[t][0], turned.triangles[t][1]);
    add("turned_faces", turned, {turned_triangles}, inside);
    add("inside_out", turned_inside_out(ball), {inside_out_shells}, inside);
    add("one_shell_inside_out", both(ball, turned_inside_out(moved(ball, {2, 0, 0}))), {inside_out_shells}, 2 * inside);
    SurfaceMesh duplicate = ball;
    for (std::size_t t = 0; t < 5; ++t) duplicate.triangles.push_back(ball.triangles[t]);
    for (std::size_t t = 10; t < 15; ++t)
        duplicate.triangles.push_back({ball.triangles[t][1], ball.triangles[t][0], ball.triangles[t][2]});
    add("duplicate_faces", duplicate, {duplicate_triangles}, inside);
    // The first triangle becomes three: two needles at a node just beside one of its corners, and the rest.
    SurfaceMesh needles = ball;
    const std::array<Index, 3> split = needles.triangles.front();
    const auto added = static_cast<Index>(needles.nodes.size());
    const auto at = [&](Index n) { return ball.nodes[static_cast<std::size_t>(n)]; };
    needles.nodes.push_back(at(split[0]) + 1e-8 * (at(split[1]) + at(split[2]) - 2 * at(split[0])));
    needles.triangles.front() = {added, split[1], split[2]};
    needles.triangles.push_back({split[0], split[1], added});
    needles.triangles.push_back({split[0], added, split[2]});
    add("needles", needles, {flat_triangles}, inside);
    // A node just above the middle of an edge of the first triangle, which only this triangle uses.
    SurfaceMesh cap = ball;
    cap.nodes.push_back(0.5 * (at(split[0]) + at(split[1])) + 1e-8 * (at(split[2]) - at(split[0])));
    cap.triangles.front() = {added, split[1], split[2]};
    cap.triangles.push_back({split[0], split[1], added});
    cap.triangles.push_back({split[0], added, split[2]});
    add("cap", cap, {slivers}, inside);
    add("soup", soup_of(ball), {}, inside);
    add("doubled", both(ball, renumbered(ball)), {duplicate_triangles, duplicate_shells}, inside);
    add("doubled_and_turned", both(ball, turned_inside_out(renumbered(ball))), {duplicate_shells}, inside);
    add("almost_doubled", both(ball, moved(scaled(renumbered(ball), 1.0001), {1e-5, 0, 0})), {duplicate_shells},
        inside);
    add("overlapping_balls", both(ball, moved(ball, {0.41, 0.13, 0.07})), {shell_crossings, doubled_volumes});
    add("overlapping_boxes", both(box, moved(box, {0.5, 0, 0})), {branching_edges, overlaps, doubled_volumes}, 1.5);
    add("touching_boxes", both(box, moved(box, {1, 0, 0})), {branching_edges, overlaps}, 2);
    const SurfaceMesh core = ball_surface(0.2, 6);
    add("cavity", both(ball, turned_inside_out(core)), {}, inside - volume_inside(core));
    add("regions", both(ball, core), {doubled_volumes}, inside);
    add("thin_wall", both(ball, turned_inside_out(scaled(ball, 0.98))), {thin_walls}, inside * (1 - std::pow(0.98, 3)));
    const auto flat = [](Real u, Real v) { return Vec3(u, v, 0.1 * u * v); };
    add("sheet", grid_surface(6, 6, GridEnds::open, false, flat), {holes});
    add("strip",
        grid_surface(40, 4, GridEnds::reversed, false,
                     [](Real u, Real v) {
                         const Real turn = 2 * std::numbers::pi * u, r = 1 + 0.4 * (v - 0.5) * std::cos(turn / 2);
                         return Vec3(r * std::cos(turn), r * std::sin(turn), 0.4 * (v - 0.5) * std::sin(turn / 2));
                     }),
        {holes, one_sided_shells});
    SurfaceMesh fin = ball;
    fin.nodes.push_back(1.5 * (at(split[0]) + at(split[1])));
    fin.triangles.push_back({split[1], split[0], added});
    add("fin", fin, {holes, branching_edges});
    SurfaceMesh cones = both(box, moved(box, {1, 1, 1}));
    add("point_joined", cones, {pinched_nodes}, 2);
    add("edge_joined", both(box, moved(box, {1, 1, 0})), {branching_edges}, 2);
    add("nanometres", scaled(ball, 1e-9), {unlikely_size}, 1e-27 * inside);
    add("millimetres", scaled(ball, 1e3), {unlikely_size}, 1e9 * inside);
    add("far_away", moved(ball, {1e6, -2e6, 3e6}), {}, inside);
    return corpus;
}

/// A closed surface of a million triangles.
inline SurfaceMesh million_triangles() {
    return torus_surface(1000, 500);
}

}  // namespace skerry::test
