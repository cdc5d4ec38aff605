// Regions solved by all workers together: against the serial solution, and against other numbers of workers.
#include <catch2/catch.hpp>

#include "systems/solver/regions/solve_large_regions.h"
#include "tests/support/contact_scene.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::large_regions_test {

namespace {

/// Two large regions, one with a hub, and small ones. Some contacts penetrate, some bounce, some have a warm start.
ContactScene large_scene() {
    ContactScene scene;
    add_sheets(scene, 22, 0.5, 1);
    const Index hub = scene.add_node(30, Vec3(0, 0, 1));
    for (Index n = 0; n < 400; n += 4) scene.touch_node(hub, n, Vec3(0.1, 0.2, -1), 0.4);
    for (int k = 0; k < 20; ++k) add_sheets(scene, 3 + k % 4, 0.3, static_cast<unsigned>(k));
    add_sheets(scene, 20, 0.2, 2);
    for (int k = 0; k < 50; ++k) scene.touch_floor(scene.add_node(1 + k, Vec3(0.1 * k, 1, -1)), 0.3);
    for (std::size_t i = 0; i < scene.stencil.size(); ++i) {
        scene.gap[i] = i % 5 == 0 ? -1e-3 : i % 5 == 1 ? 1e-3 : 0;
        scene.restitution[i] = i % 11 == 0 ? 0.4 : 0;
        scene.impulse[i] = i % 3 == 0 ? Vec3(0.2 * scene.normal[i]) : Vec3(Vec3::Zero());
    }
    return scene;
}

SolverSettings large_from(Index contacts) {
    SolverSettings settings;
    settings.parallel_region_contacts = contacts;
    // Lanes are not compared here.
    settings.small_regions_in_lanes = false;
    return settings;
}

}  // namespace

TEST_CASE("large regions have the same bits on any number of workers and any backend", "[determinism][solver]") {
    const ContactScene scene = large_scene();
    for (const SolverMethod method : {SolverMethod::ags, SolverMethod::pgs, SolverMethod::pcg_pgs}) {
        SolverSettings settings = large_from(300);
        settings.method = method;
        const SolvedScene one = scene.solve(settings);
        for (const ExecutorChoice& choice : executor_choices({1, 2, 3, 4, 8})) {
            CAPTURE(choice.text(), name_of(method));
            const SolvedScene other = scene.solve(settings, ContactRegions::separate, choice.backend, choice.workers);
            REQUIRE((one.velocity == other.velocity));
            REQUIRE((one.impulse == other.impulse));
            REQUIRE((one.push_out == other.push_out));
            REQUIRE(std::equal(one.regions.error.begin(), one.regions.error.end(), other.regions.error.begin()));
            REQUIRE(std::equal(one.regions.iterations.begin(), one.regions.iterations.end(),
                               other.regions.iterations.begin()));
            REQUIRE(std::equal(one.regions.dissipated.begin(), one.regions.dissipated.end(),
                               other.regions.dissipated.begin()));
        }
    }
}

TEST_CASE("the coloured solution is that in order, to the tolerance", "[unit][solver]") {
    const ContactScene scene = large_scene();
    SolverSettings coloured = large_from(300), in_order = large_from(1000000);
    for (SolverSettings* settings : {&coloured, &in_order}) {
        settings->tolerance = 1e-10;
        settings->max_iterations = 100000;
    }
    const SolvedScene a = scene.solve(coloured), b = scene.solve(in_order);
    REQUIRE((a.velocity != b.velocity));  // at least the order of the sums differs
    for (std::size_t r = 0; r < a.regions.size(); ++r) {
        REQUIRE(a.regions.status[r] == RegionStatus::converged);
        REQUIRE(a.regions.dissipated[r] == Approx(b.regions.dissipated[r]).epsilon(1e-6).margin(1e-9));
    }
    // 1e-10 of an impact of about 1 m/s, magnified by the worst-conditioned of some hundred contacts
    for (std::size_t n = 0; n < a.velocity.size(); ++n) REQUIRE((a.velocity[n] - b.velocity[n]).norm() < 1e-6);
    for (std::size_t n = 0; n < a.velocity.size(); ++n) REQUIRE((a.push_out[n] - b.push_out[n]).norm() < 1e-6);
}

TEST_CASE("small regions do not notice that others are large", "[determinism][solver]") {
    const ContactScene scene = large_scene();
    const SolvedScene a = scene.solve(large_from(300)), b = scene.solve(large_from(1000000));
    for (std::size_t r = 0; r < a.regions.size(); ++r) {
        if (a.regions.contacts[r].size() >= 300) continue;
        for (const Index i : a.regions.contacts[r])
            REQUIRE(a.impulse[static_cast<std::size_t>(i)] == b.impulse[static_cast<std::size_t>(i)]);
    }
}

TEST_CASE("with fixed iterations a large region is swept in order", "[determinism][solver]") {
    const ContactScene scene = large_scene();
    SolverSettings coloured = large_from(300), in_order = large_from(1000000);
    coloured.fixed_iterations = in_order.fixed_iterations = true;
    coloured.max_iterations = in_order.max_iterations = 5;
    CHECK((scene.solve(coloured).velocity == scene.solve(in_order).velocity));
}

TEST_CASE("a warm start that solves a large region needs no sweep, and a wrong one does no harm", "[unit][solver]") {
    ContactScene scene = large_scene();
    SolverSettings settings = large_from(300);
    settings.max_iterations = 10000;
    const SolvedScene first = scene.solve(settings);
    REQUIRE(first.regions.status[0] == RegionStatus::converged);
    scene.impulse = first.impulse;
    const SolvedScene second = scene.solve(settings);
    CHECK(second.regions.status[0] == RegionStatus::certified);
    for (const Index i : second.regions.contacts[0])
        REQUIRE((second.impulse[static_cast<std::size_t>(i)] - first.impulse[static_cast<std::size_t>(i)]).norm() <
                1e-12);
    for (Vec3& r : scene.impulse) r = Vec3(1e6, 0, 1e6);
    CHECK(scene.solve(settings).regions.status[0] == RegionStatus::converged);
    for (Vec3& v : scene.velocity) v = Vec3::Zero();
    for (std::size_t i = 0; i < scene.gap.size(); ++i) scene.gap[i] = 1;  // far apart, at rest
    CHECK(scene.solve(settings).regions.status[0] == RegionStatus::certified);
}

TEST_CASE("not-a-number in a large region stays there and is reported", "[unit][solver]") {
    ContactScene scene = large_scene();
    const SolvedScene good = scene.solve(large_from(300));
    scene.velocity[50].x() = std::numeric_limits<Real>::quiet_NaN();
    const SolvedScene solved = scene.solve(large_from(300));
    CHECK(solved.regions.status[0] == RegionStatus::not_finite);
    for (std::size_t r = 1; r < solved.regions.size(); ++r) {
        CHECK(solved.regions.status[r] == good.regions.status[r]);
        for (const Index i : solved.regions.contacts[r])
            REQUIRE(solved.impulse[static_cast<std::size_t>(i)] == good.impulse[static_cast<std::size_t>(i)]);
    }
}

}  // namespace skerry::test::large_regions_test
