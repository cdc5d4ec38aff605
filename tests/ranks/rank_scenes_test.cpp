// Worlds that several ranks simulate have the bits of the run without ranks.
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/world/world_state.h"
#include "skerry/ranks.h"
#include "tests/ranks/everywhere.h"
#include "tests/ranks/rank_scenes.h"
#include "tests/ranks/thread_ranks.h"
#include "tests/support/draws.h"
#include "tests/support/lively_scene.h"

namespace skerry::test {
namespace {
namespace rank_scenes_test {

RankScene own_scene(const std::string& name) {
    // m/s; with it the bodies of the scene `sleep` fall asleep sooner than by the limits that the engine chooses
    constexpr Real sleep_speed = 5e-3;
    return scene_of_file("tests/ranks/scenes/" + name + ".json", {.sleep_speed = name == "sleep" ? sleep_speed : 0});
}

/// Number of ranks, threads of each rank, and division of the bodies.
struct Division {
    int ranks, threads;
    std::string owners;
    std::function<void(World&, Ranks&)> divide;
};

Division division_by(OwnerMap map, int ranks, int threads) {
    return {ranks, threads, std::string(name_of(map)),
            [map](World& world, Ranks& mine) { distribute(world, mine, {.map = map}); }};
}

/// Divisions of which each run of the tests takes one for each scene, and all if the tests run in full. `turn`: number
/// of the scene, so that each scene takes another one.
std::vector<Division> divisions(std::size_t turn) {
    std::vector<Division> all;
    const auto add = [&](int ranks, int threads) {
        all.push_back({ranks, threads, "everywhere", hold_everywhere});
        for (const OwnerMap map : {OwnerMap::curve, OwnerMap::round_robin, OwnerMap::random})
            all.push_back(division_by(map, ranks, threads));
    };
    for (const int threads : {1, 2})
        for (const int ranks : {3, 2, 4, 8}) add(ranks, threads);
    constexpr std::size_t stride = 7;  // so that neighbouring turns differ in both the owners and the number of ranks
    if (!full_tests()) return {all[(1 + stride * turn) % all.size()]};
    add(1, 2);
    return all;
}

TEST_CASE("a run on ranks that differs is reported with the step, the body and the column", "[ranks]") {
    const RankScene scene = own_scene("pile");
    const WholeRun whole = run_whole(scene);
    CHECK(run_on_ranks_differs(scene, whole, 1, 1, [](World&, Ranks&) {}).empty());
    const auto disturb = [](World& world, Ranks&) {
        const BodyHandle body = world.bodies()[4];
        std::vector<Vec3> velocity(world.velocities(body).begin(), world.velocities(body).end());
        velocity[3].y() = std::nextafter(velocity[3].y(), 1.0);
        world.set_velocities(body, velocity);
    };
    const std::string difference = run_on_ranks_differs(scene, whole, 1, 1, disturb);
    INFO(difference);
    CHECK(difference.find("step 0, body 'ball_4': nodes.") != std::string::npos);
}

TEST_CASE("the scenes for ranks have what they are for", "[ranks]") {
    const WholeRun shots = run_whole(own_scene("shots")), surfaces = run_whole(own_scene("surfaces")),
                   region = run_whole(own_scene("one_region")), refused = run_whole(own_scene("refused")),
                   sleep = run_whole(own_scene("sleep"));
    CHECK(shots.reports.front().retried > 0);
    CHECK(surfaces.reports.back().shortened > 0);
    CHECK(region.reports.front().largest_region == region.reports.front().contacts);
    CHECK(region.reports.front().contacts > 50);
    CHECK(refused.reports.back().status == StepStatus::too_fast);
    CHECK(sleep.most_asleep == 6);
    CHECK(sleep.woken);
}

std::vector<RankScene> own_scenes() {
    std::vector<RankScene> scenes;
    for (const char* name :
         {"pile", "shots", "sleep", "stiff", "linked", "surfaces", "refused", "one_region", "constraints", "pushed"})
        scenes.push_back(own_scene(name));
    const auto slivers = [](int threads) {
        Settings settings;
        settings.threads = threads;
        return thrown_slivers(settings);
    };
    scenes.push_back({"bodies with clusters", slivers, 0.02});
    for (const char* name : {"clay", "forced", "frames", "mix", "spring_on_stiff", "fall_asleep"})
        scenes.push_back(own_scene(name));
    return scenes;
}

TEST_CASE("a scene has the same bits on any number of ranks as without ranks", "[ranks][long]") {
    std::size_t turn = 0;
    for (const RankScene& scene : own_scenes()) {
        const WholeRun whole = run_whole(scene);
        for (const Division& division : divisions(turn++)) {
            INFO("owners: " << division.owners);
            CHECK(run_on_ranks_differs(scene, whole, division.ranks, division.threads, division.divide) == "");
        }
    }
}

TEST_CASE("random scenes have the same bits on three ranks as without ranks", "[ranks][slow]") {
    constexpr int steps = 2000, scenes = 200;
    int built = 0;
    for (std::uint64_t seed = 1; built < draws(scenes); ++seed) {
        std::optional<RankScene> scene;
        try {
            scene = random_rank_scene(seed, full_tests() ? steps : steps / 20);
        } catch (const SceneError&) {  // some random scenes are refused
            continue;
        }
        ++built;
        const Division division = division_by(seed % 2 == 0 ? OwnerMap::random : OwnerMap::curve, 3, 1);
        CHECK(run_on_ranks_differs(*scene, run_whole(*scene), division.ranks, division.threads, division.divide) == "");
    }
}

/// Bytes that a rank sends in a step by the model of docs/scaling.md, for explicit bodies in a step with these
/// contacts.
double modelled_bytes(const WorldState& state) {
    constexpr double prediction = 24, label = 20, result = 56, row = 280;  // of a node, and of a contact
    constexpr double nodes_in_body = 2;                                    // of a contact
    const BodyTable& bodies = state.model.bodies;
    const RankState& ranks = state.ranks;
    const auto copies = [&](Index body) {
        return static_cast<double>(ranks.holders[static_cast<std::size_t>(body)].size());
    };
    double bytes = 0;
    for (std::size_t b = 0; b < bodies.slot.size(); ++b)
        if (ranks.leads[b]) bytes += prediction * bodies.nodes[b].size() * copies(static_cast<Index>(b));
    const ContactTable& contacts = state.scratch.contacts;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        const Index first = contacts.first_body[c], second = contacts.second_body[c];
        bytes += nodes_in_body * (label + result) * (copies(first) + (second == no_index ? 0 : copies(second)));
        // One half of the contacts that cross ranks is found by the rank that does not solve them.
        if (second != no_index && ranks.owner[first] != ranks.owner[second]) bytes += row / 2;
    }
    return bytes;
}

/// Messages of a rank in a number of steps: modelled, and counted.
struct CountedMessages {
    double bytes = 0, exchanges = 0, messages = 0;  // by the model
    double steps = 0;
    RankTraffic before, after;
};

TEST_CASE("messages, bytes and round trips of a step follow the model", "[ranks]") {
    const RankScene scene = own_scene("pile");
    double modelled = 0, sent = 0;
    for (const OwnerMap map : {OwnerMap::curve, OwnerMap::round_robin}) {
        std::vector<CountedMessages> all(3);
        run_on_ranks(3, [&](Ranks& ranks) {
            World world = scene.make(1);
            distribute(world, ranks, {.map = map});
            world.advance(scene.seconds / 2);
            CountedMessages& counted = all[static_cast<std::size_t>(ranks.rank())];
            counted.before = ranks.traffic();
            world.watch_steps([&](const StepReport&) {
                const WorldState& state = WorldAccess::state_of(std::as_const(world));
                counted.bytes += modelled_bytes(state);
                const double of_step = 3 + state.ranks.label_rounds.count;  // predictions, contacts and results
                counted.exchanges += of_step;
                counted.messages += of_step * static_cast<double>(state.ranks.peers.size());
            });
            counted.steps = world.advance(scene.seconds / 2).steps;
            counted.after = ranks.traffic();
        });
        for (const CountedMessages& of : all) {
            const auto between = [&](std::uint64_t RankTraffic::*count) {
                return static_cast<double>(of.after.*count - of.before.*count);
            };
            modelled += of.bytes;
            sent += between(&RankTraffic::bytes);
            constexpr double round_trips = 6;  // greatest number in a step
            CHECK(of.exchanges <= round_trips * of.steps);
            constexpr double rare = 1.2;  // for repeated attempts, moved copies and the ends of calls
            CHECK(between(&RankTraffic::exchanges) < rare * of.exchanges);
            CHECK(between(&RankTraffic::messages) < rare * of.messages);
            CHECK(between(&RankTraffic::reductions) + between(&RankTraffic::collectives) < rare * of.steps);
        }
    }
    CAPTURE(modelled, sent);
    CHECK(sent < 1.5 * modelled);
    CHECK(sent > modelled / 1.5);
}

/// Wall time of a step on two ranks [s], and the number of calls in it that wait for other ranks.
struct TimedStep {
    double seconds = 0, calls = 0;
};

TimedStep time_step(const RankScene& scene, std::chrono::microseconds delay) {
    TimedStep timed;
    const auto run = [&](Ranks& ranks) {
        World world = scene.make(1);
        distribute(world, ranks);
        world.advance(scene.seconds / 2);
        const RankTraffic before = ranks.traffic();
        const auto start = std::chrono::steady_clock::now();
        const double steps = world.advance(scene.seconds / 2).steps;
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
        const RankTraffic after = ranks.traffic();
        const std::uint64_t calls = after.exchanges - before.exchanges + after.reductions - before.reductions +
                                    after.collectives - before.collectives;
        if (ranks.rank() == 0) timed = {wall.count() / steps, static_cast<double>(calls) / steps};
    };
    run_on_ranks(2, run, delay);
    return timed;
}

// Needs two idle cores. docs/scaling.md has the result.
TEST_CASE("a delay of messages adds one delay to a step for each call that waits", "[.delay]") {
    const RankScene scene = own_scene("pile");
    const auto fastest = [&](std::chrono::microseconds delay) {
        TimedStep best = time_step(scene, delay);
        for (int i = 0; i < 4; ++i)
            if (const TimedStep next = time_step(scene, delay); next.seconds < best.seconds) best = next;
        return best;
    };
    const TimedStep without = fastest({});
    for (const std::chrono::microseconds delay : {std::chrono::microseconds(100), std::chrono::microseconds(1000)}) {
        const TimedStep with = fastest(delay);
        const std::chrono::duration<double> each = delay;
        WARN("delay " << 1e6 * each.count() << " us: " << 1e6 * without.seconds << " us a step become "
                      << 1e6 * with.seconds << " us, " << with.calls << " calls");
        CHECK(with.seconds - without.seconds < 1.2 * with.calls * each.count());
    }
}

}  // namespace rank_scenes_test
}  // namespace
}  // namespace skerry::test
