#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "engine/mesh/manifold_fault.h"
#include "engine/mesh/repair/part_fans.h"
#include "engine/mesh/repair/remove_flat_triangles.h"
#include "engine/mesh/repair/surface_distance.h"
#include "engine/mesh/repair/triangle_tree.h"
#include "skerry/error.h"
#include "skerry/world.h"
#include "systems/collision/build_surface.h"
#include "systems/geometry/closest_points.h"
#include "tests/support/sliver_box.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::mesh_repair_test {

using Catch::Matchers::Contains;

namespace {

std::array<Vec3, 3> corners(const SurfaceMesh& surface, const std::array<Index, 3>& t) {
    return {surface.nodes[static_cast<std::size_t>(t[0])], surface.nodes[static_cast<std::size_t>(t[1])],
            surface.nodes[static_cast<std::size_t>(t[2])]};
}

Real volume_of(const SurfaceMesh& surface) {
    Real volume = 0;
    for (const auto& t : surface.triangles) {
        const auto x = corners(surface, t);
        volume += x[0].dot(x[1].cross(x[2])) / 6;
    }
    return volume;
}

Real smallest_altitude_of(const SurfaceMesh& surface) {
    Real smallest = 1e300;
    for (const auto& t : surface.triangles) {
        const auto x = corners(surface, t);
        const Real longest = std::max({(x[1] - x[0]).norm(), (x[2] - x[1]).norm(), (x[0] - x[2]).norm()});
        smallest = std::min(smallest, (x[1] - x[0]).cross(x[2] - x[0]).norm() / longest);
    }
    return smallest;
}

/// True if every edge occurs once in each direction: the surface is closed and consistently oriented.
bool is_closed(const SurfaceMesh& surface) {
    std::map<std::pair<Index, Index>, int> count;
    for (const auto& t : surface.triangles)
        for (std::size_t a = 0; a < 3; ++a) ++count[{t[a], t[(a + 1) % 3]}];
    for (const auto& [edge, times] : count) {
        const auto back = count.find({edge.second, edge.first});
        if (times != 1 || back == count.end()) return false;
    }
    return true;
}

SurfaceMesh unit_box(int cells) {
    return mesh::boundary(test::mirrored_box(1, cells));
}

/// Row of the node nearest to `place`.
std::size_t node_at(const SurfaceMesh& surface, const Vec3& place) {
    std::size_t nearest = 0;
    for (std::size_t n = 0; n < surface.nodes.size(); ++n)
        if ((surface.nodes[n] - place).norm() < (surface.nodes[nearest] - place).norm()) nearest = n;
    return nearest;
}

}  // namespace

TEST_CASE("a mesh that is written is read back to the last bit", "[unit]") {
    const TemporaryFolder folder;
    const Mesh mesh = test::sliver_box(1.0 / 3, 3, 0.05, 1e-3);
    const std::string file = (folder.path() / "deep" / "box.msh").string();
    mesh::write(file, mesh);
    const Mesh again = mesh::read(file);
    CHECK(again.nodes == mesh.nodes);
    CHECK(again.tetrahedra == mesh.tetrahedra);
    CHECK_THROWS_WITH(mesh::write((folder.path() / "box.vtk").string(), mesh), Contains("box.vtk") && Contains(".msh"));
    Mesh broken = mesh;
    broken.tetrahedra[0][0] = -1;
    CHECK_THROWS_AS(mesh::write((folder.path() / "broken.msh").string(), broken), SceneError);
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("the tree of a surface gives the distance that all its triangles give", "[unit]") {
    const SurfaceMesh ball = mesh::boundary(mesh::ball(0.5, 6));
    const mesh::TriangleTree tree(ball);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<Real> coordinate(-1, 1);
    for (int i = 0; i < 200; ++i) {
        const Vec3 p(coordinate(random), coordinate(random), coordinate(random));
        Real least = 1e300;
        for (const auto& t : ball.triangles) {
            const auto x = corners(ball, t);
            least = std::min(least, closest_point_on_triangle(p, x[0], x[1], x[2]).distance_squared);
        }
        CHECK(tree.distance_squared(p) == least);
        CHECK(tree.distance_squared(p, least / 2) == least / 2);
    }
}

TEST_CASE("the distance of surfaces is measured both ways", "[unit]") {
    const SurfaceMesh box = unit_box(4);
    CHECK(mesh::surface_distance(box, box).greatest() < 1e-15);
    SurfaceMesh spike = box;
    spike.nodes[node_at(spike, {0, 0, 0.5})] = {0, 0, 0.8};
    const mesh::SurfaceDistance distance = mesh::surface_distance(box, spike);
    CHECK(distance.from_second == Approx(0.3));  // from the tip to the face below it
    CHECK(distance.from_first < 0.25);           // from the face to the side of the spike
    CHECK(distance.from_first > 0.1);
    CHECK(distance.greatest() == distance.from_second);
}

TEST_CASE("a needle of a flat face goes, and the surface stays where it was", "[unit]") {
    SurfaceMesh box = unit_box(4);
    box.nodes[node_at(box, {0, 0, 0.5})] = {0.24, 0, 0.5};  // 1 % of a cell away from the next node
    const Real before = smallest_altitude_of(box);
    const mesh::RepairedSurface repaired = mesh::remove_flat_triangles(box, {.tolerance = 1e-3, .altitude = 0.1});
    CHECK(before < 0.011);
    CHECK(smallest_altitude_of(repaired.surface) > 0.1);
    CHECK(repaired.collapsed + repaired.flipped > 0);
    CHECK(is_closed(repaired.surface));
    CHECK(volume_of(repaired.surface) == Approx(1));
    CHECK(mesh::surface_distance(box, repaired.surface).greatest() < 1e-12);
    // The corners of the box have not moved.
    for (const Real x : {-0.5, 0.5})
        for (const Real y : {-0.5, 0.5}) {
            const Vec3 corner(x, y, 0.5);
            CHECK(repaired.surface.nodes[node_at(repaired.surface, corner)] == corner);
        }
}

TEST_CASE("flat triangles of a ball go within the tolerance, and no further", "[unit]") {
    SurfaceMesh ball = mesh::boundary(mesh::ball(0.5, 8));
    // For every seventh triangle one node moves next to its neighbour, on the sphere.
    std::vector<bool> taken(ball.nodes.size(), false);
    for (std::size_t t = 0; t < ball.triangles.size(); t += 7) {
        const auto [a, b, c] = ball.triangles[t];
        if (taken[static_cast<std::size_t>(a)] || taken[static_cast<std::size_t>(b)]) continue;
        taken[static_cast<std::size_t>(a)] = taken[static_cast<std::size_t>(b)] = true;
        Vec3& moved = ball.nodes[static_cast<std::size_t>(a)];
        moved = (0.2 * moved + 0.8 * ball.nodes[static_cast<std::size_t>(b)]).normalized() * 0.5;
    }
    REQUIRE(is_closed(ball));
    const Real before = smallest_altitude_of(ball);
    Real last = before;
    for (const Real tolerance : {1e-9, 2e-3, 2e-2}) {
        INFO(tolerance);
        const mesh::RepairedSurface repaired =
            mesh::remove_flat_triangles(ball, {.tolerance = tolerance, .altitude = 0.05});
        CHECK(is_closed(repaired.surface));
        CHECK(mesh::surface_distance(ball, repaired.surface).greatest() <= tolerance);
        const Real after = smallest_altitude_of(repaired.surface);
        CHECK(after >= last);
        last = after;
        const mesh::RepairedSurface again =
            mesh::remove_flat_triangles(ball, {.tolerance = tolerance, .altitude = 0.05});
        CHECK(again.surface.nodes == repaired.surface.nodes);
        CHECK(again.surface.triangles == repaired.surface.triangles);
    }
    CHECK(last > 2 * before);
}

TEST_CASE("triangles that are not flat stay, and so does the smallest closed surface", "[unit]") {
    const SurfaceMesh box = unit_box(3);
    const mesh::RepairedSurface same = mesh::remove_flat_triangles(box, {.tolerance = 1, .altitude = 0.1});
    CHECK(same.surface.nodes == box.nodes);
    CHECK(same.surface.triangles == box.triangles);
    const SurfaceMesh tetrahedron = mesh::boundary({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e-3}}, {{0, 1, 2, 3}}});
    CHECK(mesh::remove_flat_triangles(tetrahedron, {.tolerance = 10, .altitude = 10}).surface.triangles.size() == 4);
}

TEST_CASE("the tetrahedra that allow the least step are the slivers", "[unit]") {
    const Mesh mesh = test::sliver_box(1, 4, 0.01, 1e-2);
    for (const ElementKind element : {ElementKind::linear, ElementKind::edge_smoothed, ElementKind::smoothed}) {
        Settings settings;
        settings.clusters = false;  // implicit elements allow any step
        World world(settings);
        const BodyHandle body = world.add_body(mesh, {.material = world.add_material({}), .element = element});
        const std::vector<Real> step = world.tetrahedron_steps(body);
        REQUIRE(step.size() == mesh.tetrahedra.size());
        const auto least = std::min_element(step.begin(), step.end());
        CHECK(*least == Approx(world.stable_step()).epsilon(1e-12));
        // The worst tetrahedron touches a node that was moved.
        const auto& worst = mesh.tetrahedra[static_cast<std::size_t>(least - step.begin())];
        bool beside = false;
        for (std::size_t t = 0; t < step.size(); ++t) {
            const auto& corner = mesh.tetrahedra[t];
            const auto x = [&](std::size_t a) { return mesh.nodes[static_cast<std::size_t>(corner[a])]; };
            const Real volume = (x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0));
            if (volume < 0.1 / 64)
                for (const Index n : corner) beside = beside || std::find(worst.begin(), worst.end(), n) != worst.end();
        }
        CHECK(beside);
    }
}

namespace {

/// A chain of cubic cells, each of which shares a face with the previous one.
Mesh chain_of_cells(const std::vector<Vec3>& cells) {
    Mesh mesh = test::mirrored_box(1, 4);
    std::erase_if(mesh.tetrahedra, [&](const std::array<Index, 4>& t) {
        Vec3 center = Vec3::Zero();
        for (const Index n : t) center += mesh.nodes[static_cast<std::size_t>(n)] / 4;
        return std::ranges::find(cells, Vec3((4 * (center + Vec3::Constant(0.5))).array().floor())) == cells.end();
    });
    return mesh;
}

}  // namespace

TEST_CASE("nodes that join tetrahedra which share no face there are parted, and nothing else changes", "[unit]") {
    const auto in_edge = GENERATE(false, true);
    INFO((in_edge ? "the ends of a chain meet in an edge" : "the ends of a chain meet in a corner"));
    std::vector<Vec3> cells{{1, 1, 1}, {0, 1, 1}, {0, 2, 1}, {0, 3, 1}, {1, 3, 1}, {2, 3, 1}};
    if (!in_edge) cells.emplace_back(2, 3, 2);
    cells.emplace_back(2, 2, in_edge ? 1 : 2);
    const Mesh mesh = chain_of_cells(cells);
    REQUIRE_FALSE(mesh::manifold_fault(boundary_triangles(mesh.tetrahedra)).empty());
    const mesh::PartedMesh parted = mesh::part_fans(mesh);
    CHECK(mesh::manifold_fault(boundary_triangles(parted.mesh.tetrahedra)).empty());
    CHECK(parted.parted == (in_edge ? 2 : 1));
    CHECK(parted.mesh.nodes.size() == mesh.nodes.size() + parted.parted);
    CHECK(parted.parts == 1);
    REQUIRE(parted.mesh.tetrahedra.size() == mesh.tetrahedra.size());
    std::size_t moved = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t k = 0; k < 4; ++k) {
            const auto before = static_cast<std::size_t>(mesh.tetrahedra[t][k]),
                       after = static_cast<std::size_t>(parted.mesh.tetrahedra[t][k]);
            CHECK(parted.mesh.nodes[after] == mesh.nodes[before]);
            moved += before != after;
        }
    CHECK(moved > 0);
}

TEST_CASE("a mesh that hangs together by a node alone falls apart in two, and one that does by faces stays", "[unit]") {
    const Mesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
                   {{0, 1, 2, 3}, {0, 5, 4, 6}}};
    const mesh::PartedMesh two = mesh::part_fans(one);
    CHECK(two.parted == 1);
    CHECK(two.parts == 2);
    const Mesh whole = test::mirrored_box(1, 3);
    const mesh::PartedMesh same = mesh::part_fans(whole);
    CHECK(same.parted == 0);
    CHECK(same.parts == 1);
    CHECK(same.mesh.tetrahedra == whole.tetrahedra);
}

TEST_CASE("an edge around which tetrahedra have a gap stays where both of its ends have one fan", "[unit]") {
    const Mesh mesh =
        chain_of_cells({{1, 1, 1}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {2, 2, 1}, {1, 1, 2}, {2, 1, 2}, {2, 2, 2}});
    const mesh::PartedMesh same = mesh::part_fans(mesh);
    CHECK(same.parted == 0);
    CHECK(same.mesh.tetrahedra == mesh.tetrahedra);
    CHECK_THAT(mesh::manifold_fault(boundary_triangles(mesh.tetrahedra)), Contains("with 4 boundary triangles"));
}

}  // namespace skerry::test::mesh_repair_test
