// Tests of the generator of random scenes, and a few random scenes in every test run. The program random_scenes runs as
// many as there is time for.
#include <catch2/catch.hpp>

#include "engine/scene/scene_plan.h"
#include "run_random_scene.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::random_scene_test {

TEST_CASE("the same seed gives the same random scene, another seed another one", "[unit]") {
    const RandomScene scene = make_random_scene(7), again = make_random_scene(7);
    CHECK(scene.json == again.json);
    CHECK(scene.changes.size() == again.changes.size());
    CHECK(scene.json != make_random_scene(8).json);
}

TEST_CASE("random scenes have meshes of all qualities", "[unit]") {
    int poor = 0;
    Real flattest = 1;  // altitude of the flattest tetrahedron over the mean edge
    for (std::uint64_t seed = 1; seed <= 60; ++seed)
        for (const auto& [name, content] : make_random_scene(seed).meshes) {
            INFO("seed " << seed << ", " << name);
            const MeshReport report = inspect(content);
            CHECK(report.inverted + report.flat == 0);
            flattest = std::min(flattest, report.min_altitude / report.mean_edge);
            ++poor;
        }
    CHECK(poor > 20);
    CHECK(flattest < 0.01);
}

TEST_CASE("random scenes run or are refused, with finite numbers all the way", "[scene][long]") {
    const TemporaryFolder folder;
    std::uint64_t steps = 0;
    Index contacts = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        INFO("seed " << seed);
        const SceneRun run = run_random_scene(make_random_scene(seed), folder.path(), {}, 2);
        steps += run.steps;
        contacts = std::max(contacts, run.max_contacts);
    }
    // Sanity check: the scenes move and touch.
    CHECK(steps > 1000);
    CHECK(contacts > 100);
}

// Regression, found by random scenes: each step with a crossing was halved again and grew back by a tenth, until time
// stood still.
TEST_CASE("time goes on in a scene where surfaces keep crossing", "[scene]") {
    ScenePlan plan = plan_scene(std::filesystem::path(SKERRY_SOURCE_DIR) / "tests/fuzz/scenes/keeps_crossing.json");
    plan.tuning.warm_start = WarmStart::off;
    Scene scene = build_scene(plan);
    std::uint64_t crossed = 0;
    for (int i = 0; i < 55; ++i) {
        const Real dt = 9.7118 * scene.world.stable_step();
        const StepReport report = scene.world.advance(dt);
        REQUIRE(report.ok());
        // ten stable steps, each halved at most seven times; the factor 2 allows for a shrinking stable step
        REQUIRE(report.steps <= 10 * 128 * 2);
        crossed += static_cast<std::uint64_t>(report.shortened);
    }
    CHECK(crossed > 0);
}

TEST_CASE("a random scene has the same bits on other threads and another backend", "[scene][determinism][long]") {
    const TemporaryFolder folder;
    for (std::uint64_t seed = 21; seed <= 24; ++seed) {
        INFO("seed " << seed);
        const RandomScene scene = make_random_scene(seed);
        const SceneRun alone = run_random_scene(scene, folder.path(), {.threads = 1, .backend = Backend::serial});
        const SceneRun together = run_random_scene(scene, folder.path(), {.threads = 3, .backend = Backend::threads});
        CHECK(alone.hash == together.hash);
        CHECK(alone.steps == together.steps);
    }
}

}  // namespace skerry::test::random_scene_test
