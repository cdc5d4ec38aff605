// Worlds that several ranks simulate have the bits of the run without ranks.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/ranks/everywhere.h"
#include "tests/ranks/rank_scenes.h"
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
    std::function<void(World&, Ranks&)> divide;
};

/// Divisions of which each run of the tests takes a part, and all if the tests run in full. `turn`: number of the
/// scene, so that each scene takes other ones.
std::vector<Division> divisions(std::size_t turn) {
    std::vector<Division> all;
    for (const int ranks : {2, 3, 4, 8})
        for (const int threads : {1, 2}) all.push_back({ranks, threads, hold_everywhere});
    if (!full_tests()) return {all[turn % all.size()]};
    all.push_back({1, 2, hold_everywhere});
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
         {"pile", "shots", "sleep", "stiff", "linked", "surfaces", "refused", "one_region", "constraints"})
        scenes.push_back(own_scene(name));
    const auto slivers = [](int threads) {
        Settings settings;
        settings.threads = threads;
        return thrown_slivers(settings);
    };
    scenes.push_back({"bodies with clusters", slivers, 0.02});
    return scenes;
}

TEST_CASE("a scene has the same bits on any number of ranks as without ranks", "[.][ranks]") {
    std::size_t turn = 0;
    for (const RankScene& scene : own_scenes()) {
        const WholeRun whole = run_whole(scene);
        for (const Division& division : divisions(turn++))
            CHECK(run_on_ranks_differs(scene, whole, division.ranks, division.threads, division.divide) == "");
    }
}

TEST_CASE("random scenes have the same bits on three ranks as without ranks", "[.][ranks]") {
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
        CHECK(run_on_ranks_differs(*scene, run_whole(*scene), 3, 1, hold_everywhere) == "");
    }
}

}  // namespace rank_scenes_test
}  // namespace
}  // namespace skerry::test
