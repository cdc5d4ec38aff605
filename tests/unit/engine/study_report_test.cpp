// Text and page of a study with known errors.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/output/table/table_page.h"
#include "engine/study/analysis/analyse.h"

namespace skerry::test::study_report_test {

namespace {

/// A bar that bends by 3 mm with a mesh error of 10 % and a step error of 1 %, and a stress that grows without limit.
StudyResult bar_study() {
    std::vector<StudyRun> runs;
    for (const StudyVariant& variant : {StudyVariant{},
                                        {.refine = 1},
                                        {.refine = -1},
                                        {.step = 0.5},
                                        {.step = 0.25},
                                        {.tolerance = 0.01},
                                        {.draw = 1},
                                        {.refine = 2}}) {
        StudyRun run;
        run.variant = variant;
        run.cpu_seconds = std::pow(16, variant.refine) / variant.step;
        if (variant.refine != 0) run.assignments = {"bodies[0].mesh.refine=" + std::to_string(variant.refine)};
        if (variant.refine == 2) {
            run.status = StudyRunStatus::left_out;
            run.message = "it needs 4 min, and the budget has 1 min left";
        } else {
            run.time = {0, 0.5, 1};
            const Real edge = std::exp2(Real{-1} * variant.refine);
            StudyColumn tip{.what = {"tip", "displacement_z", "m"}, .size = 0.1};
            StudyColumn side{.what = {"tip", "displacement_x", "m"}, .size = 0.1};
            StudyColumn stress{.what = {"root</script>", "largest_von_mises", "Pa"}, .size = 0.1, .node = 7};
            for (const Real t : run.time) {
                tip.values.push_back(-3e-3 * t * (1 - 0.1 * edge * edge + 0.01 * variant.step));
                side.values.push_back(1e-7 * t * edge);
                stress.values.push_back(2e6 * t * std::pow(edge, -0.4555));
            }
            run.columns = {tip, side, stress};
        }
        runs.push_back(run);
    }
    StudyResult result = analyse(runs, {.error = 0.05});
    result.scene = "bar.json";
    return result;
}

}  // namespace

TEST_CASE("the text of a study has a line per quantity, the verdicts and the cheapest settings", "[unit][study]") {
    CHECK(study_text(bar_study()) ==
          "study of bar.json: 7 runs, 25.1 s of CPU time, 1 left out\n"
          "  tip.displacement_z_end              = -2.73 mm +- 0.50 (18 %: mesh 0.45, step 0.045), best -3.00 +- "
          "0.12, order 2 (2 expected)\n"
          "  root</script>.largest_von_mises_end = 2 MPa, singular\n"
          "  ... and 1 value below 5 % of the largest of its kind\n"
          "  singular: root</script>.largest_von_mises_end: grows 1.37 times with each halving of the edges, at node 7 "
          "(0, 0, 0) m. Sharp inner corners, edges of clamps and point loads have no finite stress: round the corner, "
          "spread the load, or measure the stress elsewhere\n"
          "left out: mesh 2 levels finer: it needs 4 min, and the budget has 1 min left\n"
          "cheapest settings for an error of 5 %: mesh 1 level finer, steps x 0.5\n"
          "  predicted error 4.95 %, CPU time 32 s (the scene as it is: 1 s); the largest error is that of "
          "tip.displacement_z_end; 1 quantity with another verdict than known or "
          "irregular does not count\n");
}

TEST_CASE("the page of a study has all runs, quantities and series", "[unit][study]") {
    const StudyResult study = bar_study();
    const std::string page = study_page(study);
    const std::string begin = R"(<script type="application/json" id="data">)";
    const std::size_t at = page.find(begin) + begin.size();
    const nlohmann::json data = nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
    CHECK(data["rows"].size() == study.runs.size());
    CHECK(data["summary"].size() == 1 + study.quantities.size());
    REQUIRE(data["series"]["columns"].size() == 3);
    const nlohmann::json& tip = data["series"]["columns"][0];
    CHECK(tip["name"] == "tip.displacement_z [m]");
    CHECK(tip["runs"][0].size() == 3);
    CHECK(tip["runs"].back().is_null());  // the run that was left out
    CHECK(tip["band"][2].get<double>() == Approx(study.quantities[0].error));
    // The errors fall with the CPU time.
    const std::string error = data["start"]["y"];
    CHECK(error == "error of tip.displacement_z_end [m]");
    CHECK(data["rows"][1]["figures"][error] < data["rows"][0]["figures"][error]);
    CHECK(page.find("http") == page.find("http://www.w3.org/2000/svg"));  // nothing is fetched
}

}  // namespace skerry::test::study_report_test
