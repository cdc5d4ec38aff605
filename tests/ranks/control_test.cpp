// All ranks take the same decisions about steps, sleep and the end of a call, and their reports are equal.
#include <catch2/catch.hpp>
#include <mutex>
#include <vector>

#include "skerry/mesh.h"
#include "tests/ranks/everywhere.h"
#include "tests/ranks/rank_scenes.h"
#include "tests/ranks/thread_ranks.h"

namespace skerry::test {
namespace {
namespace rank_control_test {

/// Balls that fall on a plane and into each other, of which one spins.
World balls(const Settings& settings) {
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 2e4, .damping = 1});
    world.add_collider(Plane{});
    for (int i = 0; i < 5; ++i)
        world.add_body(mesh::ball(0.1, 2), {.material = rubber,
                                            .position = {0.15 * i, 0.01 * i * i, 0.11 + 0.04 * i},
                                            .velocity = {-0.3 * i, 0, -1},
                                            .angular_velocity = {0, 0, i == 2 ? 20.0 : 0.0}});
    return world;
}

TEST_CASE("a call that one rank stops ends on all ranks after the same step", "[ranks]") {
    std::mutex mutex;
    std::vector<StepReport> reports;
    run_on_ranks(3, [&](Ranks& ranks) {
        World world = balls({});
        hold_everywhere(world, ranks);
        const StepReport report =
            world.advance(1, [&](const StepReport& so_far) { return ranks.rank() != 1 || so_far.steps < 7; });
        const std::scoped_lock lock(mutex);
        reports.push_back(report);
    });
    for (const StepReport& report : reports) {
        CHECK(report.status == StepStatus::stopped);
        CHECK(report.steps == 8);  // the rank tells the others in the step that follows its request
    }
}

TEST_CASE("the balance of energy and momentum over ranks is that of an undivided world", "[ranks]") {
    constexpr Real seconds = 0.1;
    World whole = balls({});
    REQUIRE(whole.advance(seconds).ok());
    const WorldReport expected = whole.report();
    REQUIRE(expected.dissipated > 0);
    std::mutex mutex;
    std::vector<WorldReport> reports;
    run_on_ranks(3, [&](Ranks& ranks) {
        World world = balls({});
        hold_everywhere(world, ranks);
        REQUIRE(world.advance(seconds).ok());
        const std::scoped_lock lock(mutex);
        reports.push_back(world.report());
    });
    for (const WorldReport& report : reports) {
        CHECK(report.dissipated == Approx(expected.dissipated).epsilon(1e-9));
        CHECK(report.dissipated == reports[0].dissipated);
        CHECK(report.contact_sum == expected.contact_sum);
        CHECK(report.solved == expected.solved);
        CHECK(report.iteration_sum == expected.iteration_sum);
        CHECK(report.balanced_steps == expected.balanced_steps);
        // The errors of an undivided world include the time since the last check.
        CHECK(report.energy_error < 2 * expected.energy_error + 1e-12);
        CHECK(report.momentum_error < 2 * expected.momentum_error + 1e-12);
        REQUIRE(report.step_limits.size() == expected.step_limits.size());
        for (std::size_t i = 0; i < expected.step_limits.size(); ++i) {
            CHECK(report.step_limits[i].limit == expected.step_limits[i].limit);
            CHECK(report.step_limits[i].body_name == expected.step_limits[i].body_name);
            CHECK(report.step_limits[i].steps == expected.step_limits[i].steps);
        }
    }
}

TEST_CASE("energy that bodies with copies on other ranks dissipate counts once", "[ranks]") {
    const RankScene scene = scene_of_file("tests/ranks/scenes/twins.json");
    World whole = scene.make(1);
    REQUIRE(whole.advance(scene.seconds).ok());
    const WorldReport expected = whole.report();
    REQUIRE(expected.plastic_work > 0);
    REQUIRE(expected.dissipated > expected.plastic_work);
    run_on_ranks(2, [&](Ranks& ranks) {
        World world = scene.make(1);
        hold_everywhere(world, ranks);
        world.advance(scene.seconds);
        const WorldReport report = world.report();
        if (ranks.rank() != 0) return;
        CHECK(report.dissipated == Approx(expected.dissipated).epsilon(1e-9));
        CHECK(report.plastic_work == Approx(expected.plastic_work).epsilon(1e-9));
    });
}

}  // namespace rank_control_test
}  // namespace
}  // namespace skerry::test
