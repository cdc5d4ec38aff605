// Worlds that several ranks simulate have the bits of the run without ranks.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/world/world_state.h"
#include "tests/ranks/rank_scenes.h"

namespace skerry::test {
namespace {
namespace rank_scenes_test {

RankScene own_scene(const std::string& name, const Tuning& tuning = {}) {
    return scene_of_file("tests/ranks/scenes/" + name + ".json", tuning);
}

// m/s; with it the bodies of the scene `sleep` fall asleep sooner than by the limits that the engine chooses
constexpr Real sleep_speed = 5e-3;

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
                   sleep = run_whole(own_scene("sleep", {.sleep_speed = sleep_speed}));
    CHECK(shots.reports.front().retried > 0);
    CHECK(surfaces.reports.back().shortened > 0);
    CHECK(region.reports.front().largest_region == region.reports.front().contacts);
    CHECK(region.reports.front().contacts > 50);
    CHECK(refused.reports.back().status == StepStatus::too_fast);
    CHECK(sleep.most_asleep == 6);
    CHECK(sleep.woken);
}

}  // namespace rank_scenes_test
}  // namespace
}  // namespace skerry::test
