#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/mesh/manifold_fault.h"
#include "engine/mesh/require_positive.h"
#include "engine/mesh/surface/check_shells.h"
#include "skerry/error.h"
#include "skerry/mesh.h"
#include "tests/support/surface_corpus.h"

namespace skerry::test::mesh_inspect_test {

using Catch::Matchers::Contains;

namespace {

/// A regular tetrahedron with edges of length 1.
Mesh regular() {
    const Real h = std::sqrt(Real{3}) / 2;
    return {{{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}, {0.5, h / 3, std::sqrt(Real{2} / 3)}}, {{0, 1, 2, 3}}};
}

}  // namespace

TEST_CASE("a regular tetrahedron has quality 1 and its closed form measures", "[unit]") {
    const MeshReport report = inspect(regular());
    CHECK(report.nodes == 4);
    CHECK(report.boundary_triangles == 4);
    CHECK(report.components == 1);
    CHECK(report.volume == Approx(1 / (6 * std::sqrt(2.0))));
    CHECK(report.mean_edge == Approx(1));
    CHECK(report.min_edge == Approx(1));
    CHECK(report.max_edge == Approx(1));
    CHECK(report.min_altitude == Approx(std::sqrt(2.0 / 3)));
    CHECK(report.min_quality == Approx(1));
    CHECK(report.mean_quality == Approx(1));
    CHECK(report.closed_manifold);
    CHECK(report.upper[2] == Approx(std::sqrt(2.0 / 3)));
}

TEST_CASE("inverted and flat tetrahedra are counted apart", "[unit]") {
    Mesh mesh = regular();
    mesh.nodes.push_back({0.5, 0.3, 0});  // in the plane of nodes 0, 1, 2
    mesh.nodes.push_back({0.5, 0.3, -1});
    mesh.tetrahedra.push_back({0, 1, 2, 4});
    mesh.tetrahedra.push_back({0, 1, 2, 5});
    const MeshReport report = inspect(mesh);
    CHECK(report.flat == 1);
    CHECK(report.inverted == 1);
    CHECK(report.min_altitude == 0);
    CHECK(report.min_quality < 0);
    CHECK_THROWS_WITH(
        mesh::require_positive(mesh, "wreck.msh"),
        Contains("wreck.msh: tetrahedron 1 (nodes 0 1 2 4): rest volume: found 0 m^3, expected a positive volume") &&
            Contains("inverted: 1, flat: 1 of 3 tetrahedra"));
}

TEST_CASE("flat does not depend on the unit of length", "[unit]") {
    for (const Real scale : {1e-6, 1.0, 1e6}) {
        Mesh thin = regular();
        thin.nodes[3] = {0.5, 0.3, 1e-4};  // a sliver, not flat
        for (Vec3& x : thin.nodes) x *= scale;
        CHECK(inspect(thin).flat == 0);
        CHECK(inspect(thin).slivers == 1);
        CHECK_NOTHROW(mesh::require_positive(thin, "sliver"));
        thin.nodes[3][2] = 1e-14 * scale;
        CHECK(inspect(thin).flat == 1);
    }
}

TEST_CASE("two tetrahedra that meet in one edge are one piece but no manifold", "[unit]") {
    Mesh mesh = regular();
    mesh.nodes.push_back({0, -1, -1});
    mesh.nodes.push_back({1, -1, -1});
    mesh.tetrahedra.push_back({0, 1, 5, 4});
    const MeshReport report = inspect(mesh);
    CHECK(report.components == 1);
    CHECK_FALSE(report.closed_manifold);
}

TEST_CASE("two tetrahedra that meet in one node are no manifold, and the node is named", "[unit]") {
    Mesh mesh = regular();
    for (const Vec3& x : {Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)}) mesh.nodes.push_back(mesh.nodes[0] + x);
    mesh.tetrahedra.push_back({0, 5, 4, 6});
    CHECK(inspect(mesh).components == 1);
    CHECK_FALSE(inspect(mesh).closed_manifold);
    CHECK(mesh::manifold_fault(boundary_triangles(mesh.tetrahedra)) ==
          "node 0, at which parts of the boundary meet without a common edge");
    CHECK(mesh::manifold_fault(boundary_triangles(mesh::ball(1, 4).tetrahedra)).empty());
    mesh.tetrahedra.back() = {0, 1, 4, 5};
    CHECK(mesh::manifold_fault(boundary_triangles(mesh.tetrahedra)) ==
          "an edge between nodes 0 and 1 with 4 boundary triangles instead of 2");
    CHECK(inspect(mesh).boundary_fault == mesh::manifold_fault(boundary_triangles(mesh.tetrahedra)));
    CHECK(mesh::manifold_fault({}) == "no boundary triangle");
    const Mesh far = mesh;
    for (const Vec3& x : far.nodes) mesh.nodes.push_back(x + Vec3(10, 0, 0));
    for (std::array<Index, 4> t : far.tetrahedra) {
        for (Index& n : t) n += static_cast<Index>(far.nodes.size());
        mesh.tetrahedra.push_back(t);
    }
    CHECK(mesh::manifold_fault(boundary_triangles(mesh.tetrahedra)) ==
          "an edge between nodes 0 and 1 with 4 boundary triangles instead of 2 (2 such edges in total)");
}

TEST_CASE("separate tetrahedra are separate pieces, unused nodes none", "[unit]") {
    Mesh mesh = regular();
    for (std::size_t n = 0; n < 4; ++n) mesh.nodes.push_back(mesh.nodes[n] + Vec3(5, 0, 0));
    mesh.tetrahedra.push_back({4, 5, 6, 7});
    mesh.nodes.push_back({9, 9, 9});
    CHECK(inspect(mesh).components == 2);
    CHECK(mesh::boundary(mesh).nodes.size() == 8);
}

TEST_CASE("the report of an empty mesh is all zeros", "[unit]") {
    const MeshReport report = inspect({});
    CHECK(report.nodes == 0);
    CHECK(report.volume == 0);
    CHECK(report.min_edge == 0);
    CHECK_FALSE(report.closed_manifold);
    CHECK(mesh::boundary({}).triangles.empty());
    CHECK_THROWS_WITH(mesh::require_positive({}, "nothing"), Contains("nothing: mesh: found no tetrahedra"));
}

TEST_CASE("rows and nodes that cannot be are refused", "[unit]") {
    Mesh mesh = regular();
    mesh.tetrahedra[0][2] = 4;
    CHECK_THROWS_WITH(inspect(mesh), Contains("tetrahedron 0: node: found 4, expected a node index from 0 to 3"));
    CHECK_THROWS_WITH(mesh::boundary(mesh), Contains("found 4"));
    mesh.tetrahedra[0][2] = 1;
    CHECK_THROWS_WITH(mesh::require_positive(mesh, "a"), Contains("1 twice"));
    mesh = regular();
    mesh.nodes[1][0] = std::nan("");
    CHECK_THROWS_WITH(mesh::require_positive(mesh, "a"), Contains("a: node 1: position"));
}

TEST_CASE("aligned or nested shells that overlap are refused, and shells that only touch are not", "[unit]") {
    const auto joined = [](Real size, Real shift) {
        SurfaceMesh both = mesh::boundary(mesh::box({1, 1, 1}, {1, 1, 1}));
        const SurfaceMesh other = mesh::boundary(mesh::box({size, size, size}, {1, 1, 1}));
        const auto count = static_cast<Index>(both.nodes.size());
        for (const Vec3& node : other.nodes) both.nodes.push_back(node + Vec3(shift, 0, 0));
        for (const auto& t : other.triangles) both.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
        return both;
    };
    for (const auto& [size, shift] : {std::pair<Real, Real>{1, 0.5}, {0.5, 0.1}, {1, 0}}) {
        CAPTURE(size, shift);
        CHECK_THROWS_WITH(mesh::require_shells(joined(size, shift), "part", false),
                          Contains("part: mesh: triangles") && Contains("expected shells that do not overlap") &&
                              Contains("give mass, center_of_mass and inertia"));
        CHECK_NOTHROW(mesh::require_shells(joined(size, shift), "part", true));
    }
    CHECK_NOTHROW(mesh::require_shells(joined(1, 1), "part", false));
    CHECK_NOTHROW(mesh::require_shells(joined(1, 3), "part", false));
    // Boxes with common nodes, as in STL files.
    const SurfaceMesh box = box_surface(Vec3::Ones());
    CHECK_THROWS_WITH(mesh::require_shells(mesh::weld(both(box, moved(box, {0.5, 0, 0})), 0), "part", false),
                      Contains("enclose the same volume twice"));
    CHECK_NOTHROW(mesh::require_shells(mesh::weld(both(box, moved(box, {1, 0, 0})), 0), "part", false));
}

TEST_CASE("boundary triangles face outwards", "[unit]") {
    const SurfaceMesh surface = mesh::boundary(mesh::box({1, 1, 1}, {3, 2, 2}));
    Real volume = 0;  // by the divergence theorem
    for (const auto& t : surface.triangles) {
        Mat3 corners;
        for (int a = 0; a < 3; ++a)
            corners.col(a) = surface.nodes[static_cast<std::size_t>(t[static_cast<std::size_t>(a)])];
        volume += corners.col(0).dot(corners.col(1).cross(corners.col(2))) / 6;
    }
    CHECK(volume == Approx(1));
    CHECK(surface.triangles.size() == 4 * (3 * 2 + 3 * 2 + 2 * 2));
}

}  // namespace skerry::test::mesh_inspect_test
