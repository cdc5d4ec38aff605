#include "systems/collision/build_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include "tests/support/meshes.h"

namespace skerry::test::build_surface_test {

using test::SolidMesh;

namespace {

struct Built {
    SolidMesh mesh;
    SurfaceTables surface;
    SurfaceRanges ranges;
};

Built build(const SolidMesh& mesh, Index first_node = 0) {
    Built built{mesh, {}, {}};
    built.ranges = append_surface(boundary_triangles(mesh.tetrahedra), first_node, 80, built.surface);
    return built;
}

}  // namespace

TEST_CASE("the surface of a box has Euler's counts, is closed and looks outward", "[unit]") {
    const Vec3 size(2, 3, 4);
    const Built b = build(test::box_mesh({2, 3, 4}, size));
    const Index triangles = 2 * 2 * (2 * 3 + 3 * 4 + 4 * 2);
    CHECK(b.ranges.triangles.size() == triangles);
    CHECK(b.ranges.edges.size() == 3 * triangles / 2);
    CHECK(b.ranges.vertices.size() == 2 + triangles / 2);

    Real volume = 0;
    std::map<std::array<Index, 2>, int> directed;
    for (const auto& n : b.surface.triangles.node) {
        const Vec3 &p = b.mesh.nodes[n[0]], &q = b.mesh.nodes[n[1]], &r = b.mesh.nodes[n[2]];
        volume += p.dot(q.cross(r)) / 6;
        CHECK((q - p).cross(r - p).dot(p + q + r) > 0);
        for (std::size_t k = 0; k < 3; ++k) ++directed[{n[k], n[(k + 1) % 3]}];
    }
    CHECK(volume == Approx(size.prod()));
    for (const auto& [edge, count] : directed) {
        CHECK(count == 1);
        CHECK(directed.count({edge[1], edge[0]}) == 1);
    }
}

TEST_CASE("each vertex and each edge is owned once, by the lowest triangle that has it", "[unit]") {
    const Built b = build(test::ball_mesh(1, 3));
    const TriangleTable& t = b.surface.triangles;
    std::map<Index, Index> vertex_owner, edge_owner;
    for (std::size_t row = 0; row < t.node.size(); ++row)
        for (std::size_t k = 0; k < 3; ++k) {
            const bool first_vertex = vertex_owner.emplace(t.vertex[row][k], static_cast<Index>(row)).second;
            const bool first_edge = edge_owner.emplace(t.edge[row][k], static_cast<Index>(row)).second;
            CHECK(bool(t.owned_vertices[row] >> k & 1) == first_vertex);
            CHECK(bool(t.owned_edges[row] >> k & 1) == first_edge);
        }
    CHECK(static_cast<Index>(vertex_owner.size()) == b.ranges.vertices.size());
    CHECK(static_cast<Index>(edge_owner.size()) == b.ranges.edges.size());
}

TEST_CASE("faces, nodes and edges have the order of sorting by comparison", "[unit]") {
    std::mt19937_64 random(2);
    for (const std::size_t count : {0, 1, 40, 300}) {
        // Not a valid mesh of a body: tetrahedra overlap, and faces belong to more than two of them.
        std::vector<std::array<Index, 4>> tetrahedra(count);
        for (auto& tetrahedron : tetrahedra)
            for (std::size_t k = 0; k < 4; ++k) {
                const auto is_there = [&](Index n) {
                    return std::find(tetrahedron.begin(), tetrahedron.begin() + k, n) != tetrahedron.begin() + k;
                };
                do tetrahedron[k] = static_cast<Index>(random() % 17);
                while (is_there(tetrahedron[k]));
            }
        constexpr std::array<std::array<std::size_t, 3>, 4> outward{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
        using Face = std::tuple<std::array<Index, 3>, Index, int, bool>;
        std::vector<Face> by_comparison, found;
        std::map<std::array<Index, 3>, int> times;
        for (std::size_t t = 0; t < count; ++t)
            for (std::size_t k = 0; k < 4; ++k) {
                std::array<Index, 3> node;
                for (std::size_t i = 0; i < 3; ++i) node[i] = tetrahedra[t][outward[k][i]];
                const auto [a, b, c] = node;
                std::ranges::sort(node);
                const bool even =
                    node == std::array{a, b, c} || node == std::array{b, c, a} || node == std::array{c, a, b};
                by_comparison.emplace_back(node, static_cast<Index>(t), static_cast<int>(k), !even);
                ++times[node];
            }
        std::ranges::sort(by_comparison);
        for (const TetrahedronFace& face : sorted_faces(tetrahedra))
            found.emplace_back(face.node, face.tetrahedron, face.corner, face.turned);
        CHECK(found == by_comparison);

        const std::vector<BoundaryTriangle> triangles = boundary_triangles(tetrahedra);
        std::vector<std::array<Index, 3>> single;
        for (std::size_t t = 0; t < count; ++t)
            for (const auto& corner : outward) {
                const std::array<Index, 3> node{tetrahedra[t][corner[0]], tetrahedra[t][corner[1]],
                                                tetrahedra[t][corner[2]]};
                std::array<Index, 3> sorted = node;
                std::ranges::sort(sorted);
                if (times[sorted] == 1) single.push_back(node);
            }
        REQUIRE(triangles.size() == single.size());
        std::set<Index> nodes;
        std::set<std::array<Index, 2>> edges;
        for (std::size_t t = 0; t < single.size(); ++t) {
            CHECK(triangles[t].node == single[t]);
            for (std::size_t k = 0; k < 3; ++k) {
                nodes.insert(single[t][k]);
                edges.insert(
                    {std::min(single[t][k], single[t][(k + 1) % 3]), std::max(single[t][k], single[t][(k + 1) % 3])});
            }
        }
        SurfaceTables surface;
        append_surface(triangles, 0, 0, surface);
        CHECK(std::ranges::equal(surface.vertices.node, nodes));
        CHECK(std::ranges::equal(surface.edges.node, edges));
    }
}

TEST_CASE("triangles, edges and vertices refer to each other", "[unit]") {
    const Index first_node = 100;
    const Built b = build(test::box_mesh({2, 2, 2}, {1, 1, 1}), first_node);
    const SurfaceTables& s = b.surface;
    for (std::size_t row = 0; row < s.triangles.node.size(); ++row) {
        CHECK(s.triangles.element[row] >= 80);
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = s.triangles.node[row][k], c = s.triangles.node[row][(k + 1) % 3];
            CHECK(a >= first_node);
            const auto& edge = s.edges.node[s.triangles.edge[row][k]];
            CHECK(edge == std::array<Index, 2>{std::min(a, c), std::max(a, c)});
            const auto& around = s.edges.triangle[s.triangles.edge[row][k]];
            CHECK(around[0] < around[1]);
            CHECK((around[0] == static_cast<Index>(row) || around[1] == static_cast<Index>(row)));
            CHECK(s.vertices.node[s.triangles.vertex[row][k]] == a);
        }
    }
    for (std::size_t v = 0; v < s.vertices.node.size(); ++v) {
        CHECK(s.vertices.triangle_end[v] > s.vertices.triangle_begin[v]);
        for (Index i = s.vertices.triangle_begin[v]; i < s.vertices.triangle_end[v]; ++i) {
            const auto& node = s.triangles.node[s.vertex_triangle[i]];
            CHECK(std::find(node.begin(), node.end(), s.vertices.node[v]) != node.end());
        }
    }
    // The middle node of 3 x 3 x 3 is inside.
    CHECK(std::find(s.vertices.node.begin(), s.vertices.node.end(), first_node + 13) == s.vertices.node.end());
}

TEST_CASE("a second body is appended after the first and shares nothing with it", "[unit]") {
    SurfaceTables surface;
    const auto triangles = boundary_triangles(test::box_mesh({1, 1, 1}, {1, 1, 1}).tetrahedra);
    const SurfaceRanges first = append_surface(triangles, 0, 0, surface);
    const SurfaceRanges second = append_surface(triangles, 8, 8, surface);
    CHECK(second.triangles.begin == first.triangles.end);
    CHECK(second.edges.begin == first.edges.end);
    CHECK(second.vertices.begin == first.vertices.end);
    for (Index t = second.triangles.begin; t < second.triangles.end; ++t) {
        CHECK(surface.triangles.node[t][0] == surface.triangles.node[t - second.triangles.begin][0] + 8);
        CHECK(surface.triangles.edge[t][0] >= second.edges.begin);
        CHECK(surface.triangles.vertex[t][0] >= second.vertices.begin);
    }
    for (Index v = second.vertices.begin; v < second.vertices.end; ++v)
        CHECK(surface.vertex_triangle[surface.vertices.triangle_begin[v]] >= second.triangles.begin);
}

TEST_CASE("an open surface has rims with one triangle", "[unit]") {
    SurfaceTables surface;
    const std::vector<BoundaryTriangle> sheet{{{0, 1, 2}, no_index}, {{0, 2, 3}, no_index}};
    append_surface(sheet, 0, no_index, surface);
    int rims = 0;
    for (const auto& around : surface.edges.triangle) rims += around[1] == no_index;
    CHECK(rims == 4);
    CHECK(surface.triangles.element[0] == no_index);
}

TEST_CASE("nothing has no boundary, one tetrahedron has four faces", "[unit]") {
    CHECK(boundary_triangles({}).empty());
    SurfaceTables surface;
    const SurfaceRanges none = append_surface({}, 0, 0, surface);
    CHECK(none.triangles.size() + none.edges.size() + none.vertices.size() == 0);
    const std::array<std::array<Index, 4>, 1> one{{{0, 1, 2, 3}}};
    CHECK(boundary_triangles(one).size() == 4);
}

TEST_CASE("a triangle that is three times one node is a point: one vertex, no edges", "[unit]") {
    SurfaceTables surface;
    const std::vector<BoundaryTriangle> point{{{0, 0, 0}, no_index}};
    append_surface(point, 5, no_index, surface);
    const SurfaceRanges ranges = append_surface(point, 7, no_index, surface);
    CHECK(ranges.triangles.size() == 1);
    CHECK(ranges.vertices.size() == 1);
    CHECK(ranges.edges.size() == 0);
    CHECK(surface.vertices.node[1] == 7);
    CHECK(surface.triangles.node[1] == std::array<Index, 3>{7, 7, 7});
    CHECK(surface.triangles.owned_vertices[1] == 1);
    CHECK(surface.triangles.owned_edges[1] == 0);
    for (const Index edge : surface.triangles.edge[1]) CHECK(edge == no_index);
}

}  // namespace skerry::test::build_surface_test
