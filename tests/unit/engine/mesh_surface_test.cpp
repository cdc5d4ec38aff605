#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "skerry/error.h"
#include "systems/geometry/passes_through.h"
#include "tests/support/draws.h"
#include "tests/support/surface_corpus.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/engine/mesh_samples.h"

namespace skerry::test::mesh_surface_test {

namespace {

using Catch::Matchers::Contains;

std::vector<std::string> names_of(const std::vector<SurfaceFaultKind>& kinds) {
    std::vector<std::string> names;
    for (const SurfaceFaultKind kind : kinds) names.emplace_back(name_of(kind));
    return names;
}

/// Names of the faults, with the texts that show where the test failed.
std::vector<std::string> found_in(const SurfaceReport& report) {
    std::vector<std::string> names;
    for (const SurfaceFault& fault : report.faults) {
        UNSCOPED_INFO(mesh::fault_text(fault));
        names.emplace_back(name_of(fault.kind));
    }
    return names;
}

const SurfaceFault& fault_of(const SurfaceReport& report, SurfaceFaultKind kind) {
    const SurfaceFault* fault = report.find(kind);
    REQUIRE(fault != nullptr);
    return *fault;
}

}  // namespace

TEST_CASE("a check finds exactly the faults of each surface, in any direction", "[unit][surface]") {
    const Mat3 turn = (Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized())).toRotationMatrix();
    for (CorpusSurface& entry : surface_corpus()) {
        CAPTURE(entry.name);
        CHECK(found_in(mesh::check_surface(entry.surface)) == names_of(entry.faults));
        for (Vec3& x : entry.surface.nodes) x = turn * x;
        CHECK(found_in(mesh::check_surface(entry.surface)) == names_of(entry.faults));
    }
}

TEST_CASE("a cleaned surface has no fault that cleaning repairs, and the volume of its solid", "[unit][surface]") {
    for (const CorpusSurface& entry : surface_corpus()) {
        CAPTURE(entry.name);
        const SurfaceReport report = mesh::check_surface(entry.surface);
        const SurfaceReport again = mesh::check_surface(report.cleaned);
        for (const SurfaceFault& fault : again.faults) CHECK(fault.kind > SurfaceFaultKind::duplicate_shells);
        CHECK(again.merged == 0);
        if (!report.can_be_filled()) continue;
        REQUIRE(entry.volume.has_value());
        // rounding errors of welding, which moves nodes by up to 1e-6 of the size
        CHECK(report.volume == Approx(*entry.volume).epsilon(3e-6));
        CHECK(report.volume == Approx(again.volume).epsilon(1e-9));
    }
}

TEST_CASE("holes have their length, their centre and a triangle", "[unit][surface]") {
    // One square of four is missing in each of two sides of a unit cube; in the lower side it is one of one square.
    SurfaceMesh cube = mesh::boundary(mesh::box({1, 1, 1}, {2, 2, 2}));
    const auto drop = [&](const Vec3& lower, const Vec3& upper) {
        std::erase_if(cube.triangles, [&](const std::array<Index, 3>& triangle) {
            return std::ranges::all_of(triangle, [&](Index n) {
                const Vec3& x = cube.nodes[static_cast<std::size_t>(n)];
                return (x.array() >= lower.array()).all() && (x.array() <= upper.array()).all();
            });
        });
    };
    drop({0, 0, 0.5}, {0.5, 0.5, 0.5});
    drop({-0.5, -0.5, -0.5}, {0.5, 0.5, -0.5});
    const SurfaceReport report = mesh::check_surface(cube);
    const SurfaceFault& fault = fault_of(report, SurfaceFaultKind::holes);
    CHECK(fault.count == 2);
    CHECK(fault.length == Approx(4));
    CHECK((fault.place - Vec3(0, 0, -0.5)).norm() < 1e-12);
    CHECK_THAT(mesh::fault_text(fault), Contains("2 holes, the longest 4 m around at (0, 0, -0.5) m, triangle "));
    CHECK_FALSE(report.can_be_filled());
    CHECK_FALSE(report.shells.at(0).closed);
    CHECK(report.volume == 0);
    CHECK(report.area == Approx(6 - 1.25));
}

TEST_CASE("faults name the number of the triangle in the given surface and its place", "[unit][surface]") {
    SurfaceMesh ball = ball_surface(0.5);
    const auto count = static_cast<Index>(ball.triangles.size());
    ball.triangles.insert(ball.triangles.begin() + 3, {5, 5, 7});  // flat: triangle 3
    ball.triangles.push_back(ball.triangles[10]);                  // repeated: triangle count + 1
    std::swap(ball.triangles[20][0], ball.triangles[20][1]);
    const SurfaceReport report = mesh::check_surface(ball);
    CHECK(fault_of(report, SurfaceFaultKind::flat_triangles).triangle == 3);
    CHECK(fault_of(report, SurfaceFaultKind::duplicate_triangles).triangle == count + 1);
    const SurfaceFault& turned = fault_of(report, SurfaceFaultKind::turned_triangles);
    CHECK(turned.triangle == 20);
    Vec3 centre = Vec3::Zero();
    for (const Index n : ball.triangles[20]) centre += ball.nodes[static_cast<std::size_t>(n)] / 3;
    CHECK((turned.place - centre).norm() < 1e-9);
    CHECK(report.triangles == static_cast<std::size_t>(count) + 2);
    CHECK(report.cleaned.triangles.size() == static_cast<std::size_t>(count));
    CHECK(report.number.at(3) == 4);
}

TEST_CASE("shells know the shells around them, and keep their orientation to these", "[unit][surface]") {
    // A ball in a void of a ball, in which a smaller one lies; beside it a ball that is inside out with its void.
    const SurfaceMesh ball = ball_surface(1, 6);
    SurfaceMesh nested = both(ball, turned_inside_out(scaled(ball, 0.8)));
    nested = both(nested, both(scaled(ball, 0.6), scaled(ball, 0.4)));
    nested = both(nested, turned_inside_out(moved(both(ball, turned_inside_out(scaled(ball, 0.5))), {3, 0, 0})));
    const SurfaceReport report = mesh::check_surface(nested);
    REQUIRE(report.shells.size() == 6);
    const std::vector<Index> around{no_index, 0, 1, 2, no_index, 4};
    const std::vector<Real> cubes{1, -0.512, 0.216, 0.064, 1, -0.125};
    for (std::size_t s = 0; s < 6; ++s) {
        CAPTURE(s);
        CHECK(report.shells[s].around == around[s]);
        CHECK(report.shells[s].volume == Approx(cubes[s] * volume_inside(ball)));
    }
    CHECK(fault_of(report, SurfaceFaultKind::inside_out_shells).count == 1);
    CHECK(fault_of(report, SurfaceFaultKind::doubled_volumes).count == ball.triangles.size());
    CHECK(report.volume == Approx((1 - 0.512 + 0.216 + 1 - 0.125) * volume_inside(ball)));
}

TEST_CASE("two random triangles cross where an edge of one passes through the other", "[unit][surface]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> at(-1, 1);
    std::size_t crossing = 0;
    for (int i = 0; i < draws(20000); ++i) {
        SurfaceMesh pair{{}, {{0, 1, 2}, {3, 4, 5}}};
        for (int n = 0; n < 6; ++n) pair.nodes.emplace_back(at(random), at(random), at(random));
        const auto& x = pair.nodes;
        bool expected = false;
        for (std::size_t k = 0; k < 3; ++k)
            expected = expected || passes_through(x[k], x[(k + 1) % 3], x[3], x[4], x[5]) ||
                       passes_through(x[3 + k], x[3 + (k + 1) % 3], x[0], x[1], x[2]);
        crossing += expected;
        CHECK((mesh::check_surface(pair).find(SurfaceFaultKind::shell_crossings) != nullptr) == expected);
    }
    CHECK(crossing > 200);
}

TEST_CASE("neighbours that fold back onto each other overlap, and those that only meet do not", "[unit][surface]") {
    // Two triangles with a common edge; the angle between them is 0 when they lie on each other.
    const auto overlaps_at = [](Real angle) {
        const SurfaceMesh pair{{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.4, 0.9 * std::cos(angle), 0.9 * std::sin(angle)}},
                               {{0, 1, 2}, {1, 0, 3}}};
        const SurfaceReport report = mesh::check_surface(pair);
        CHECK_FALSE(report.find(SurfaceFaultKind::crossings));
        return report.find(SurfaceFaultKind::overlaps) != nullptr;
    };
    CHECK(overlaps_at(0));
    CHECK_FALSE(overlaps_at(0.01));
    CHECK_FALSE(overlaps_at(std::numbers::pi));
    // A third corner in the interior of the other triangle, at one common node.
    const SurfaceMesh at_node{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.4, 0.4, 0}, {0.2, 0.3, 1}}, {{0, 1, 2}, {0, 3, 4}}};
    CHECK_FALSE(mesh::check_surface(at_node).find(SurfaceFaultKind::crossings));
    SurfaceMesh through = at_node;
    through.nodes[3].z() = -0.2;
    CHECK(mesh::check_surface(through).find(SurfaceFaultKind::crossings) == nullptr);
    CHECK(mesh::check_surface(through).find(SurfaceFaultKind::shell_crossings) != nullptr);
}

TEST_CASE("a surface in millimetres or nanometres is noticed", "[unit][surface]") {
    for (const Real scale : {1e3, 1e-9}) {
        const SurfaceReport report = mesh::check_surface(scaled(box_surface({1, 1, 1}), scale));
        CHECK(fault_of(report, SurfaceFaultKind::unlikely_size).length == Approx(std::sqrt(3.0) * scale));
        CHECK(report.can_be_filled());
    }
    CHECK_THAT(mesh::fault_text({.kind = SurfaceFaultKind::unlikely_size, .count = 1, .length = 1732}),
               Contains("a size of 1732 m, probably in another unit"));
}

TEST_CASE("welding merges nodes up to the distance, in chains, and keeps the order", "[unit][surface]") {
    const SurfaceMesh soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-3, 0, 0}, {1, 1e-3, 0}, {1, 1, 0}, {2e-3, 0, 0}},
                           {{0, 1, 2}, {3, 0, 6}, {4, 5, 2}, {6, 4, 5}}};
    std::vector<Index> number;
    const SurfaceMesh welded = mesh::weld(soup, 1.1e-3, &number);
    CHECK(number == std::vector<Index>{0, 2, 3});
    CHECK(welded.nodes == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
    CHECK(welded.triangles == std::vector<std::array<Index, 3>>{{0, 1, 2}, {1, 3, 2}, {0, 1, 3}});
    CHECK(mesh::weld(soup, 0.9e-3).nodes.size() == 7);
    const SurfaceMesh ball = ball_surface(0.5);
    const SurfaceMesh equal = mesh::weld(soup_of(ball), 0);
    CHECK(equal.nodes.size() == ball.nodes.size());
    CHECK(equal.triangles.size() == ball.triangles.size());
    CHECK(mesh::weld(soup_of(ball), mesh::no_weld).nodes.size() == 3 * ball.triangles.size());
    const SurfaceReport report = mesh::check_surface(soup_of(ball));
    CHECK(report.merged == 3 * ball.triangles.size() - ball.nodes.size());
    CHECK(report.shells.size() == 1);
}

TEST_CASE("surfaces with wrong numbers are refused by name", "[unit][surface]") {
    SurfaceMesh ball = ball_surface(0.5);
    ball.nodes[3].y() = std::nan("");
    CHECK_THROWS_WITH(mesh::check_surface(ball, mesh::default_weld, "ball.obj"),
                      Contains("ball.obj: node 3: position"));
    ball = ball_surface(0.5);
    ball.triangles[4][1] = 1000000;
    CHECK_THROWS_WITH(mesh::check_surface(ball), Contains("triangle 4: node: found 1000000"));
    CHECK_THROWS_WITH(mesh::check_surface({}), Contains("no triangles"));
    CHECK_THROWS_WITH(mesh::check_surface(ball_surface(0.5), 1), Contains("surface: tolerance: found 1, expected"));
    // All triangles have two corners in one place.
    const SurfaceReport none = mesh::check_surface({{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}});
    CHECK(found_in(none) == names_of({SurfaceFaultKind::flat_triangles}));
    CHECK_FALSE(none.can_be_filled());
}

TEST_CASE("a million triangles are checked", "[unit][surface]") {
    const SurfaceMesh surface = full_tests() ? million_triangles() : torus_surface(60, 30);
    const SurfaceReport report = mesh::check_surface(surface);
    CHECK(found_in(report).empty());
    CHECK(report.can_be_filled());
    CHECK(report.shells.size() == 1);
    // 2 pi^2 R r^2. Chords reduce the area of each of the two circles by the factor 1 - (2 pi / n)^2 / 6.
    CHECK(report.volume == Approx(2 * std::numbers::pi * std::numbers::pi * 0.09).epsilon(0.01));
}

TEST_CASE("damaged files of surfaces are refused with their place, and quads and counting back are read",
          "[unit][surface]") {
    const TemporaryFolder folder;
    const SurfaceMesh ball = ball_surface(0.5);
    const std::string stl = stl_file(ball, true), text = stl_file(ball, false), obj = obj_file(ball);
    const std::size_t vertex = text.find("vertex", text.size() / 2);
    for (const auto& [name, content, expected] : std::vector<std::array<std::string, 3>>{
             {"cut.stl", stl.substr(0, stl.size() / 2), "the file is incomplete"},
             {"nan.stl", text.substr(0, vertex) + "vertex nan 0 0\n" + text.substr(text.find('\n', vertex)),
              "found nan"},
             {"empty.stl", "", "an empty file"},
             {"empty.obj", "", "no triangles"},
             {"nan.obj", "v 0 nan 0\n" + obj, "line 1: position: found nan"},
             {"cut.obj", obj.substr(0, obj.rfind(' ')), "2 corners"}}) {
        CAPTURE(name);
        CHECK_THROWS_WITH(mesh::read_surface(folder.write(name, content)), Contains(name) && Contains(expected));
    }
    const SurfaceMesh cube = mesh::read_surface(folder.write(
        "cube.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf -4 -3 -2 -1\n"
        "f 1 2 6 5\nf 2 3 7 6\nf -6/1 -5/2 -1/3 -2/4\nf 4//1 1//1 5//1 8//1\n"));
    const SurfaceReport report = mesh::check_surface(cube);
    CHECK(found_in(report).empty());
    CHECK(report.volume == Approx(1));
}

}  // namespace skerry::test::mesh_surface_test
