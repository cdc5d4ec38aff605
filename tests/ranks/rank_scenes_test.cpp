// Worlds that several ranks simulate have the bits of the run without ranks.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <mutex>
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

TEST_CASE("messages, bytes and round trips of a step follow the model", "[ranks]") {
    const RankScene scene = own_scene("pile");
    std::mutex mutex;
    double modelled = 0, sent = 0;
    for (const OwnerMap map : {OwnerMap::curve, OwnerMap::round_robin})
        run_on_ranks(3, [&](Ranks& ranks) {
            World world = scene.make(1);
            distribute(world, ranks, {.map = map});
            world.advance(scene.seconds / 2);
            const RankTraffic before = ranks.traffic();
            double bytes = 0, exchanges = 0, messages = 0;
            world.watch_steps([&](const StepReport&) {
                const WorldState& state = WorldAccess::state_of(std::as_const(world));
                bytes += modelled_bytes(state);
                const double of_step = 3 + state.ranks.label_rounds.count;  // predictions, contacts and results
                exchanges += of_step;
                messages += of_step * static_cast<double>(state.ranks.peers.size());
            });
            const StepReport report = world.advance(scene.seconds / 2);
            const RankTraffic after = ranks.traffic();
            const std::scoped_lock lock(mutex);
            modelled += bytes;
            sent += static_cast<double>(after.bytes - before.bytes);
            constexpr double round_trips = 6;  // greatest number in a step
            CHECK(exchanges <= round_trips * report.steps);
            constexpr double rare = 1.2;  // for repeated attempts, moved copies and the ends of calls
            CHECK(static_cast<double>(after.exchanges - before.exchanges) < rare * exchanges);
            CHECK(static_cast<double>(after.messages - before.messages) < rare * messages);
            CHECK(static_cast<double>(after.reductions - before.reductions + after.collectives - before.collectives) <
                  rare * report.steps);
        });
    CAPTURE(modelled, sent);
    CHECK(sent < 1.5 * modelled);
    CHECK(sent > modelled / 1.5);
}

}  // namespace rank_scenes_test
}  // namespace
}  // namespace skerry::test
