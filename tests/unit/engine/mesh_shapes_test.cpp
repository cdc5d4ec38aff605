#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "engine/mesh/require_positive.h"
#include "skerry/error.h"
#include "skerry/mesh.h"

namespace skerry::test::mesh_shapes_test {

namespace {

const Real pi = std::acos(Real{-1});

/// Checks the properties that every built-in mesh must have.
void check_sound(const Mesh& mesh) {
    CHECK_NOTHROW(mesh::require_positive(mesh, "mesh"));
    const MeshReport report = inspect(mesh);
    CHECK(report.closed_manifold);
    CHECK(report.components == 1);
    // The mesh is conforming: a face belongs to at most two tetrahedra. It has no holes: the boundary has V - E + F = 2
    // with E = 3 F / 2.
    std::map<std::array<Index, 3>, int> faces;
    for (const auto& t : mesh.tetrahedra)
        for (std::size_t skip = 0; skip < 4; ++skip) {
            std::array<Index, 3> face{t[(skip + 1) % 4], t[(skip + 2) % 4], t[(skip + 3) % 4]};
            std::sort(face.begin(), face.end());
            faces[face] += 1;
        }
    std::size_t boundary = 0;
    int most = 0;
    for (const auto& [face, count] : faces) {
        boundary += count == 1;
        most = std::max(most, count);
    }
    CHECK(most == 2);
    CHECK(boundary == report.boundary_triangles);
    const SurfaceMesh surface = mesh::boundary(mesh);
    CHECK(static_cast<int>(surface.nodes.size()) - static_cast<int>(surface.triangles.size()) / 2 == 2);
}

Real altitude_over_edge(const Mesh& mesh) {
    const MeshReport report = inspect(mesh);
    return report.min_altitude / report.mean_edge;
}

}  // namespace

TEST_CASE("a box has the volume of its size and fills its cells", "[unit]") {
    const auto cells = GENERATE(std::array<int, 3>{1, 1, 1}, std::array<int, 3>{2, 1, 3}, std::array<int, 3>{4, 4, 4});
    const Mesh box = mesh::box({1, 2, 3}, cells);
    check_sound(box);
    const MeshReport report = inspect(box);
    CHECK(report.volume == Approx(6).epsilon(1e-12));
    CHECK(report.tetrahedra == static_cast<std::size_t>(6 * cells[0] * cells[1] * cells[2]));
    CHECK(report.nodes == static_cast<std::size_t>((cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1)));
    CHECK((report.lower + Vec3(0.5, 1, 1.5)).norm() < 1e-15);
    CHECK((report.upper - Vec3(0.5, 1, 1.5)).norm() < 1e-15);
}

TEST_CASE("the cells of a box mirror each other: an even box is its own mirror image", "[unit]") {
    const Mesh box = mesh::box({1, 1, 1}, {2, 2, 2});
    std::map<std::array<long, 3>, Index> node_at;
    const auto key = [](const Vec3& x) {
        return std::array<long, 3>{std::lround(4 * x[0]), std::lround(4 * x[1]), std::lround(4 * x[2])};
    };
    for (std::size_t n = 0; n < box.nodes.size(); ++n) node_at[key(box.nodes[n])] = static_cast<Index>(n);
    std::set<std::set<Index>> tetrahedra;
    for (const auto& t : box.tetrahedra) tetrahedra.insert({t.begin(), t.end()});
    for (int axis = 0; axis < 3; ++axis)
        for (const auto& t : box.tetrahedra) {
            std::set<Index> mirrored;
            for (const Index n : t) {
                Vec3 x = box.nodes[static_cast<std::size_t>(n)];
                x[axis] = -x[axis];
                mirrored.insert(node_at.at(key(x)));
            }
            CHECK(tetrahedra.count(mirrored) == 1);
        }
}

TEST_CASE("all boundary nodes of a ball lie on the sphere", "[unit]") {
    const int resolution = GENERATE(1, 2, 3, 4, 6, 8, 12);
    const Mesh ball = mesh::ball(0.1, resolution);
    check_sound(ball);
    for (const Vec3& x : mesh::boundary(ball).nodes) CHECK(x.norm() == Approx(0.1).epsilon(1e-14));
    CHECK(altitude_over_edge(ball) > 0.5);  // 0.53 in the limit of many shells
}

TEST_CASE("the volume of a ball converges with the square of its resolution", "[unit]") {
    const Real exact = 4 * pi / 3;
    const Real coarse = exact - inspect(mesh::ball(1, 8)).volume, fine = exact - inspect(mesh::ball(1, 16)).volume;
    CHECK(coarse / exact < 0.035);
    CHECK(coarse / fine == Approx(4).epsilon(0.05));
}

TEST_CASE("a cylinder is a prism that nears the round one", "[unit]") {
    const int resolution = GENERATE(2, 4, 5, 8);
    const Mesh cylinder = mesh::cylinder(0.1, 0.3, resolution);
    check_sound(cylinder);
    const int sides = 6 * ((resolution + 1) / 2);
    CHECK(inspect(cylinder).volume == Approx(0.3 * 0.01 * sides / 2 * std::sin(2 * pi / sides)));
    CHECK(altitude_over_edge(cylinder) > 0.45);
    for (const Vec3& x : mesh::boundary(cylinder).nodes) {
        const bool round = std::abs(std::hypot(x[0], x[1]) - 0.1) < 1e-14,
                   end = std::abs(std::abs(x[2]) - 0.15) < 1e-14;
        CHECK((round || end));
    }
}

TEST_CASE("a flat cylinder has one layer", "[unit]") {
    const Mesh disc = mesh::cylinder(1, 0.01, 8);
    check_sound(disc);
    CHECK(inspect(disc).volume > 0);
}

TEST_CASE("the outline of a lathe bounds its nodes, and its volume converges", "[unit]") {
    const std::array<std::array<Real, 2>, 4> vase{{{0.06, 0}, {0.1, 0.1}, {0.04, 0.25}, {0.07, 0.3}}};
    Real exact = 0;
    for (std::size_t i = 0; i + 1 < vase.size(); ++i) {
        const Real a = vase[i][0], b = vase[i + 1][0];
        exact += pi / 3 * (a * a + a * b + b * b) * (vase[i + 1][1] - vase[i][1]);
    }
    Real error_prev = 1;
    for (const int resolution : {4, 8, 16}) {
        const Mesh mesh = mesh::lathe(vase, resolution);
        check_sound(mesh);
        CHECK(altitude_over_edge(mesh) > 0.25);
        const Real error = std::abs(inspect(mesh).volume / exact - 1);
        CHECK(error < 0.5 * error_prev);
        error_prev = error;
        // A kink of the outline has its own layer if there is room for layers between the kinks.
        CHECK(inspect(mesh).upper[0] == Approx(0.1));
    }
    CHECK(error_prev < 0.01);
}

TEST_CASE("outlines with sudden steps, thin ends or hardly any height still give sound meshes", "[unit]") {
    using Profile = std::vector<std::array<Real, 2>>;
    const Profile profile = GENERATE(
        Profile{{0.1, 0}, {0.1, 0.1}, {0.05, 0.1001}, {0.05, 0.2}}, Profile{{0.1, 0}, {0.0001, 0.3}},
        Profile{{1e-4, 0}, {0.1, 0.02}, {1e-4, 0.04}}, Profile{{0.1, 0}, {0.1, 1}}, Profile{{0.01, 0}, {1, 0.001}},
        Profile{{0.1, 0}, {1e-5, 0.1}, {0.1, 0.2}}, Profile{{1e-4, -0.1}, {0.1, -0.09}, {0.1, 0.09}, {1e-4, 0.1}});
    const int resolution = GENERATE(1, 2, 5, 8);
    check_sound(mesh::lathe(profile, resolution));
}

TEST_CASE("a skittle of medium resolution has a few hundred good tetrahedra", "[unit]") {
    const Mesh skittle = mesh::skittle(0.4, 4);
    check_sound(skittle);
    const MeshReport report = inspect(skittle);
    CHECK(report.tetrahedra >= 300);
    CHECK(report.tetrahedra <= 600);
    CHECK(report.lower[2] == 0);
    CHECK(report.upper[2] == Approx(0.4));
    CHECK(altitude_over_edge(skittle) > 0.35);
    for (const int resolution : {6, 8, 12}) CHECK(altitude_over_edge(mesh::skittle(0.4, resolution)) > 0.3);
}

TEST_CASE("a table stands on four legs", "[unit]") {
    const int cells = GENERATE(1, 2);
    mesh::TableShape shape;
    shape.cells_per_leg = cells;
    const Mesh table = mesh::table(shape);
    check_sound(table);
    CHECK(inspect(table).volume == Approx(0.5 * 0.3 * 0.05 + 4 * 0.05 * 0.05 * 0.25));
    CHECK(altitude_over_edge(table) > 0.5);
    int standing = 0;
    for (const Vec3& x : table.nodes) standing += x[2] == 0;
    CHECK(standing == 4 * (cells + 1) * (cells + 1));
}

TEST_CASE("the same call gives the same mesh", "[unit][determinism]") {
    const Mesh first = mesh::skittle(0.4, 6), again = mesh::skittle(0.4, 6);
    CHECK(first.tetrahedra == again.tetrahedra);
    CHECK(first.nodes == again.nodes);
}

TEST_CASE("sizes that are not positive and meshes too large to index are refused", "[unit]") {
    const Real nan = std::nan("");
    CHECK_THROWS_AS(mesh::box({1, 0, 1}, {1, 1, 1}), SceneError);
    CHECK_THROWS_AS(mesh::box({1, nan, 1}, {1, 1, 1}), SceneError);
    CHECK_THROWS_AS(mesh::box({1, 1, 1}, {1, 0, 1}), SceneError);
    CHECK_THROWS_AS(mesh::box({1, 1, 1}, {100000, 100000, 100000}), SceneError);
    CHECK_THROWS_AS(mesh::ball(-1, 4), SceneError);
    CHECK_THROWS_AS(mesh::ball(1, 0), SceneError);
    CHECK_THROWS_AS(mesh::ball(1, 1000000000), SceneError);
    CHECK_THROWS_AS(mesh::cylinder(1, 0, 4), SceneError);
    CHECK_THROWS_AS(mesh::cylinder(1e-9, 1e9, 4), SceneError);
    CHECK_THROWS_AS(mesh::skittle(nan, 4), SceneError);
    CHECK_THROWS_AS(mesh::lathe({}, 4), SceneError);
    CHECK_THROWS_AS(mesh::lathe(std::array<std::array<Real, 2>, 2>{{{1, 0}, {1, 0}}}, 4), SceneError);
    CHECK_THROWS_AS(mesh::lathe(std::array<std::array<Real, 2>, 2>{{{1, 0}, {0, 1}}}, 4), SceneError);
    mesh::TableShape wide_legs;
    wide_legs.leg = 0.2;
    CHECK_THROWS_AS(mesh::table(wide_legs), SceneError);
    mesh::TableShape thick;
    thick.thickness = 0.3;
    CHECK_THROWS_AS(mesh::table(thick), SceneError);
    mesh::TableShape fine;
    fine.cells_per_leg = 2000000;
    CHECK_THROWS_AS(mesh::table(fine), SceneError);
    CHECK_THROWS_WITH(mesh::box({1, 1, 1}, {1 << 20, 1 << 20, 1 << 20}),
                      "box: cells: found a mesh of about 6.91753e+18 elements, expected at most 536870911, because "
                      "indices have 32 bits");
}

TEST_CASE("the drawn mesh of a sphere begins with its middle and corners around it, and lies on it", "[unit]") {
    const Mesh picture = mesh::sphere_picture(2);
    CHECK(picture.nodes.size() == 163);
    CHECK(picture.tetrahedra.size() == 320);
    CHECK(picture.nodes[0] == Vec3::Zero());
    for (std::size_t n = 1; n < picture.nodes.size(); ++n) CHECK(picture.nodes[n].norm() == Approx(2));
    Vec3 sum = Vec3::Zero();
    for (std::size_t n = 1; n <= 12; ++n) sum += picture.nodes[n];
    CHECK(sum.norm() < 1e-12);
    // Every direction has a corner near it.
    for (const Vec3& x : picture.nodes) {
        Real most = 0;
        for (std::size_t n = 1; n <= 12; ++n) most = std::max(most, x.dot(picture.nodes[n]));
        if (!x.isZero(0)) CHECK(most > 0.75 * 4);
    }
    check_sound(picture);
}

}  // namespace skerry::test::mesh_shapes_test
