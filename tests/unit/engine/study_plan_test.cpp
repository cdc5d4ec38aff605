// Plan of a study: costs of its runs, the budget, assignments, and flat faces.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/study/flat_faces.h"
#include "engine/study/plan_study.h"

namespace skerry::test::study_plan_test {

TEST_CASE("the largest number of iterations of a study is a valid number") {
    StudiedScene scene;
    scene.settings.max_iterations = 300'000'000;
    CHECK(variant_assignments(scene, {.tolerance = 0.01}, 1e-3).back() == "settings.max_iterations=2147483640");
}

TEST_CASE("the budget leaves out the costly runs, which are the less important ones") {
    CHECK(wall_time({4, 1, 1, 2}, 1) == 8);
    CHECK(wall_time({1, 1, 1, 1}, 2) == 2);
    CHECK(wall_time({17, 1, 1, 1}, 2) == Approx(17 / 1.7 + 1.5));  // the long run gets both threads
    std::vector<PlannedRun> plan{{{}, 1, {}, StudyStage::start},
                                 {{.draw = 1}, 1, {}, StudyStage::start},
                                 {{.step = 0.5}, 2, {}, StudyStage::basic},
                                 {{.refine = -1}, 0.1, "no coarser meshes", StudyStage::basic},
                                 {{.refine = 1}, 16, {}, StudyStage::finer},
                                 {{.step = 0.25}, 4, {}, StudyStage::last}};
    keep_to_budget(10, 1, 2, plan);
    std::vector<bool> made;
    for (const PlannedRun& run : plan) made.push_back(run.reason.empty());
    CHECK(made == std::vector<bool>{true, true, true, false, false, true});
    CHECK(plan[3].reason == "no coarser meshes");
    CHECK(plan[4].reason ==
          "with it the study would take about 20 times as long as one run, more than the budget of 10 (--budget)");
    keep_to_budget(1, 1, plan.size(), plan);  // runs that are made already stay
    CHECK(plan[5].reason.empty());
}

TEST_CASE("the cost of a finer mesh follows from the coarser ones, and grows by at most 16 per level") {
    StudiedScene scene;
    scene.has_explicit = true;
    const auto cost = [&](double coarse, std::optional<double> fine) {
        std::vector<PlannedRun> plan{
            {{}, 1, {}}, {{.refine = -1}, 1. / 16, {}}, {{.refine = 1}, 16, {}}, {{.refine = 2}, 256, {}}};
        std::vector<StudyRun> runs(plan.size());
        for (StudyRun& run : runs) run.status = StudyRunStatus::left_out;
        const auto make = [&](std::size_t i, double seconds) {
            runs[i].status = StudyRunStatus::ok;
            runs[i].cpu_seconds = seconds;
        };
        make(0, 2);
        make(1, coarse);
        if (fine) make(2, *fine);
        predict_levels(scene, runs, plan);
        return std::pair{plan[2].cost, plan[3].cost};
    };
    CHECK(cost(0.25, {}) == std::pair{12.0, 256.0});    // 1.5 times the ratio of the coarser levels
    CHECK(cost(0.1, {}).first == 16);                   // at most the ratio of tetrahedra and steps
    CHECK(cost(1, {}).first == 8);                      // at least the ratio of tetrahedra
    CHECK(cost(0.25, 20.0) == std::pair{10.0, 150.0});  // measured, and 1.5 times 10 times that
}

TEST_CASE("flat faces of a cylinder are off by a twelfth of the square of their angle, those of a box are not") {
    constexpr int count = 24;
    constexpr Real angle = 2 * std::numbers::pi / count;
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 3>> triangles;
    for (int i = 0; i < count; ++i) {
        for (const Real z : {0.0, 0.3}) nodes.emplace_back(2 * std::cos(i * angle), 2 * std::sin(i * angle), z);
        const Index a = 2 * i, b = 2 * ((i + 1) % count);
        triangles.push_back({a, b, b + 1});
        triangles.push_back({a, b + 1, a + 1});
    }
    const FlatFaces round = flat_faces(nodes, triangles);
    CHECK(round.share == Approx(angle * angle / 12).epsilon(0.01));  // next term: a share of angle^2 / 12
    CHECK(round.angle == Approx(angle));
    const std::vector<Vec3> corner{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    CHECK(flat_faces(corner, std::vector<std::array<Index, 3>>{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}).share == 0);
}

}  // namespace skerry::test::study_plan_test
