// Shortcuts of the solver: each one is taken, counted, and changes results only within the tolerance.
#include <catch2/catch.hpp>

#include "tests/support/contact_scene.h"

namespace skerry::test::shortcuts_test {

namespace {

SolverSettings tight() {
    SolverSettings settings;
    settings.tolerance = 1e-8;
    settings.max_iterations = 20000;
    return settings;
}

std::size_t count(const SolvedScene& solved, RegionShortcut which) {
    return static_cast<std::size_t>(std::count_if(solved.regions.shortcut.begin(), solved.regions.shortcut.end(),
                                                  [which](RegionShortcut s) { return (s & which) != 0; }));
}

Real largest_difference(const SolvedScene& a, const SolvedScene& b) {
    Real largest = 0;
    for (std::size_t n = 0; n < a.velocity.size(); ++n)
        largest = std::max(largest, (a.velocity[n] - b.velocity[n]).norm());
    return largest;
}

/// Difference of velocities that the tolerance allows in an ill-conditioned region, at some metres per second [m/s].
constexpr Real allowed = 1e-5;

}  // namespace

TEST_CASE("the certificate of a warm start can be switched off", "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 8, 0.5, 2);
    scene.impulse = scene.solve(tight()).impulse;
    SolverSettings off = tight();
    off.certify_warm_start = false;
    const SolvedScene certified = scene.solve(tight()), swept = scene.solve(off);
    CHECK(count(certified, shortcut_certified) == 1);
    CHECK(certified.regions.iterations[0] == 0);
    CHECK(count(swept, shortcut_certified) == 0);
    CHECK(swept.regions.iterations[0] >= 1);
    CHECK(largest_difference(certified, swept) < allowed);
}

TEST_CASE("regions that separate can be swept all the same", "[unit][solver]") {
    ContactScene scene;
    const Index a = scene.add_node(1, Vec3(0.1, 0, 1)), b = scene.add_node(1, Vec3(0, 0.2, 0.5));
    scene.touch_floor(a, 0.5);
    scene.touch_node(a, b, Vec3::UnitZ(), 0.5);
    scene.impulse.assign(2, Vec3(0, 0, 3));
    for (const bool lanes : {true, false}) {
        SolverSettings off = tight();
        off.skip_separating = false;
        off.small_regions_in_lanes = lanes;
        const SolvedScene skipped = scene.solve(tight()), swept = scene.solve(off);
        CHECK(count(skipped, shortcut_separating) == 1);
        CHECK(count(swept, shortcut_separating) == 0);
        CHECK(swept.regions.status[0] == RegionStatus::converged);
        CHECK(skipped.velocity == swept.velocity);
    }
}

TEST_CASE("one row a contact does the sweeps of three where there is no friction", "[unit][solver]") {
    for (const bool warm : {false, true}) {
        ContactScene scene;
        add_sheets(scene, 9, 0, 4);
        // a warm start with tangential impulses, as after a change of friction
        if (warm) scene.impulse.assign(scene.stencil.size(), Vec3(0.05, 0.02, 0.1));
        SolverSettings off = tight();
        off.frictionless_rows = false;
        const SolvedScene rows = scene.solve(tight()), vectors = scene.solve(off);
        CHECK(count(rows, shortcut_frictionless) == 1);
        CHECK(count(vectors, shortcut_frictionless) == 0);
        CHECK(rows.regions.status[0] == RegionStatus::converged);
        CHECK(std::abs(rows.regions.iterations[0] - vectors.regions.iterations[0]) <= 2);  // rounding can move a check
        CHECK(largest_difference(rows, vectors) < allowed);
        for (std::size_t i = 0; i < scene.stencil.size(); ++i)
            CHECK((rows.impulse[i] - rows.impulse[i].dot(scene.normal[i]) * scene.normal[i]).norm() < 1e-12);
    }
}

TEST_CASE("one row a contact keeps the best iterate when it does not converge, and not-a-number is reported",
          "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 10, 0, 3);
    SolverSettings settings;
    settings.tolerance = 1e-10;
    settings.max_iterations = 7;
    const SolvedScene solved = scene.solve(settings);
    CHECK(count(solved, shortcut_frictionless) == 1);
    CHECK(solved.regions.status[0] == RegionStatus::iteration_limit);
    CHECK(solved.regions.iterations[0] == 7);
    std::vector<Vec3> expected = scene.velocity;
    for (std::size_t i = 0; i < scene.stencil.size(); ++i)
        for (std::size_t a = 0; a < 4; ++a) {
            const auto node = static_cast<std::size_t>(scene.stencil[i].node[a]);
            expected[node] += scene.stencil[i].weight[a] * scene.inverse_mass[node] * solved.impulse[i];
        }
    for (std::size_t n = 0; n < expected.size(); ++n) CHECK((expected[n] - solved.velocity[n]).norm() < 1e-12);
    scene.velocity[45].x() = std::numeric_limits<Real>::quiet_NaN();
    CHECK(scene.solve(settings).regions.status[0] == RegionStatus::not_finite);
}

TEST_CASE("all shortcuts off change nothing beyond the tolerance", "[unit][solver]") {
    ContactScene scene;
    for (int k = 0; k < 12; ++k) add_sheets(scene, 3 + k % 5, k % 3 == 0 ? 0 : 0.5, static_cast<unsigned>(k));
    SolverSettings off = tight();
    off.certify_warm_start = off.skip_separating = off.frictionless_rows = off.small_regions_in_lanes = false;
    CHECK(largest_difference(scene.solve(tight()), scene.solve(off)) < allowed);
}

}  // namespace skerry::test::shortcuts_test
