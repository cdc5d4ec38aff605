// All ranks take the same decisions about steps, sleep and the end of a call, and their reports are equal.
#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "engine/world/world_state.h"
#include "skerry/mesh.h"
#include "skerry/ranks.h"
#include "tests/ranks/everywhere.h"
#include "tests/ranks/rank_scenes.h"
#include "tests/ranks/thread_ranks.h"
#include "tests/support/lively_scene.h"

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
    std::vector<StepReport> reports(3);
    run_on_ranks(3, [&](Ranks& ranks) {
        World world = balls({});
        hold_everywhere(world, ranks);
        reports[static_cast<std::size_t>(ranks.rank())] =
            world.advance(1, [&](const StepReport& so_far) { return ranks.rank() != 1 || so_far.steps < 7; });
    });
    for (const StepReport& report : reports) {
        CHECK(report.status == StepStatus::stopped);
        CHECK(report.steps == 8);  // the rank tells the others in the step that follows its request
    }
}

TEST_CASE("a call of one step that one rank stops is reported as stopped on all ranks", "[ranks]") {
    std::vector<StepReport> reports(2);
    run_on_ranks(2, [&](Ranks& ranks) {
        World world;
        const auto rubber = world.add_material({.young_modulus = 2e4});
        // far apart, so that the ranks repeat no attempt
        for (const Real x : {0, 10}) world.add_body(mesh::ball(0.1, 2), {.material = rubber, .position = {x, 0, 0}});
        const Real step = world.stable_step() / 2;
        distribute(world, ranks);
        world.advance(step);
        reports[static_cast<std::size_t>(ranks.rank())] =
            world.advance(step, [&](const StepReport&) { return ranks.rank() != 1; });
    });
    for (const StepReport& report : reports) {
        CHECK(report.status == StepStatus::stopped);
        CHECK(report.steps == 1);
    }
}

TEST_CASE("the balance of energy and momentum over ranks is that of an undivided world", "[ranks]") {
    constexpr Real seconds = 0.1;
    World whole = balls({});
    REQUIRE(whole.advance(seconds).ok());
    const WorldReport expected = whole.report();
    REQUIRE(expected.dissipated > 0);
    std::vector<WorldReport> reports(3);
    std::vector<StepStatus> status(3);
    run_on_ranks(3, [&](Ranks& ranks) {
        World world = balls({});
        hold_everywhere(world, ranks);
        const auto rank = static_cast<std::size_t>(ranks.rank());
        status[rank] = world.advance(seconds).status;
        reports[rank] = world.report();
    });
    CHECK(status == std::vector<StepStatus>(3, StepStatus::ok));
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
    WorldReport report;
    run_on_ranks(2, [&](Ranks& ranks) {
        World world = scene.make(1);
        hold_everywhere(world, ranks);
        world.advance(scene.seconds);
        const WorldReport of_rank = world.report();
        if (ranks.rank() == 0) report = of_rank;
    });
    CHECK(report.dissipated == Approx(expected.dissipated).epsilon(1e-9));
    CHECK(report.plastic_work == Approx(expected.plastic_work).epsilon(1e-9));
}

/// Sum of the assumed moduli of all implicit elements [Pa].
Real sum_of_moduli(const World& world) {
    Real sum = 0;
    for (const ElementLane& lanes : WorldAccess::state_of(world).model.elements.implicit_modulus)
        for (const Real modulus : lanes.lane) sum += modulus;
    return sum;
}

TEST_CASE("clusters become as stiff as without ranks if ranks abandon the attempts in which they do", "[ranks]") {
    constexpr Real seconds = 0.045;
    World whole = thrown_slivers({.threads = 1});
    REQUIRE(whole.advance(0).ok());
    const Real before = sum_of_moduli(whole);
    REQUIRE(whole.advance(seconds).ok());
    REQUIRE(sum_of_moduli(whole) > before);
    const auto leave_labels_open = [](RankState& ranks) { ranks.label_rounds.count = 0; };
    const auto let_ghosts_expire = [](RankState& ranks) { ranks.margin.assign(ranks.margin.size(), 0); };
    for (const std::function<void(RankState&)>& spoil_attempt :
         {std::function<void(RankState&)>(leave_labels_open), std::function<void(RankState&)>(let_ghosts_expire)}) {
        std::uint64_t hash = 0, reductions = 0;
        Real work = 0;
        run_on_ranks(2, [&](Ranks& ranks) {
            World world = thrown_slivers({.threads = 1});
            distribute(world, ranks);
            WorldState& state = WorldAccess::state_of(world);
            world.advance(0);
            spoil_attempt(state.ranks);
            world.watch_steps([&](const StepReport&) { spoil_attempt(state.ranks); });
            world.advance(seconds);
            world.watch_steps({});
            const Real of_all_ranks = state.record.balance.work;
            if (const std::optional<World> all = gathered(world)) {
                hash = all->state_hash();
                work = of_all_ranks;
                reductions = ranks.traffic().reductions;
            }
        });
        CHECK(hash == whole.state_hash());
        CHECK(reductions >= 2 * whole.report().steps);  // one in each attempt
        CHECK(work == Approx(WorldAccess::state_of(whole).record.balance.work).epsilon(1e-9));
    }
}

}  // namespace rank_control_test
}  // namespace
}  // namespace skerry::test
