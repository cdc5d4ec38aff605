// Studies: their runs, the budget, stopping and continuing, and the cheapest settings.
#include <unistd.h>
#include <fstream>

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <ostream>

#include "engine/base/write_file.h"
#include "engine/scene/parse_json.h"
#include "engine/scene/scene_plan.h"
#include "engine/scene/write_scene.h"
#include "engine/study/plan_study.h"
#include "engine/study/run_file.h"
#include "engine/study/run_variant.h"
#include "engine/study/study_columns.h"
#include "skerry/error.h"
#include "skerry/study.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::study_test {

namespace {

/// A bar that is held at one end and falls on a floor with the other.
const std::string bar = R"({"name": "bar", "seconds": 0.1, "frame_step": 0.01,
    "materials": {"rubber": {"E": 1e5, "rho": 1000, "nu": 0.3}},
    "bodies": [{"name": "arm", "mesh": {"box": {"size": [0.2, 0.05, 0.05], "cells": [4, 2, 2]}}, "material": "rubber",
                "element": "linear", "position": [0, 0, 0.0255],
                "pin": [{"box": {"lower": [-1, -1, -1], "upper": [-0.099, 1, 1]}}]}],
    "colliders": [{"name": "floor", "shape": {"plane": {}}}],
    "probes": [{"name": "tip", "quantity": "motion", "body": "arm", "point": [0.1, 0, 0]}]})";

/// A bar that is held at the upper end and comes to rest under its weight.
const std::string hanging = R"({"name": "hanging", "seconds": 0.2, "frame_step": 0.02,
    "materials": {"rubber": {"E": 1e5, "rho": 1000, "nu": 0.3, "damping": 100}},
    "bodies": [{"name": "arm", "mesh": {"box": {"size": [0.1, 0.1, 0.2], "cells": [2, 2, 4]}}, "material": "rubber",
                "element": "linear", "pin": [{"box": {"lower": [-1, -1, 0.099], "upper": [1, 1, 1]}}]}]})";

/// Settings for a budget that admits one finer mesh and no more.
StudySettings small_study(const std::filesystem::path& folder = {}) {
    return {.threads = 1, .budget = 26, .folder = folder};
}

std::vector<std::string> names_of_runs(const StudyResult& result, StudyRunStatus status) {
    std::vector<std::string> names;
    for (const StudyRun& run : result.runs)
        if (run.status == status) names.push_back(variant_name(run.variant));
    return names;
}

const StudyQuantity& quantity(const StudyResult& result, const std::string& name) {
    const auto found = std::ranges::find(result.quantities, name, &StudyQuantity::name);
    REQUIRE(found != result.quantities.end());
    return *found;
}

bool same_bits(Real a, Real b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

/// Requires that all numbers of two results are the same, except CPU times.
void require_same(const StudyResult& a, const StudyResult& b) {
    REQUIRE(a.runs.size() == b.runs.size());
    for (std::size_t r = 0; r < a.runs.size(); ++r) {
        REQUIRE(a.runs[r].variant == b.runs[r].variant);
        REQUIRE(a.runs[r].state_hash == b.runs[r].state_hash);
        REQUIRE(a.runs[r].columns.size() == b.runs[r].columns.size());
        for (std::size_t c = 0; c < a.runs[r].columns.size(); ++c)
            REQUIRE(std::ranges::equal(a.runs[r].columns[c].values, b.runs[r].columns[c].values, same_bits));
    }
    REQUIRE(a.quantities.size() == b.quantities.size());
    for (std::size_t q = 0; q < a.quantities.size(); ++q) {
        REQUIRE(a.quantities[q].name == b.quantities[q].name);
        REQUIRE(same_bits(a.quantities[q].value, b.quantities[q].value));
        REQUIRE(same_bits(a.quantities[q].error, b.quantities[q].error));
    }
}

std::string message_of(const std::filesystem::path& scene, const StudySettings& settings) {
    try {
        study(scene, settings);
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

/// State of a scene with assignments after the calls of advance of a run without probes.
std::uint64_t hash_after(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
    SceneOverrides overrides{.threads = 1};
    overrides.assignments = assignments;
    Scene scene = load_scene(file, overrides);
    for (int frame = 0; frame < std::lround(scene.seconds / scene.probe_step); ++frame)
        REQUIRE(scene.world.advance(scene.probe_step).ok());
    return scene.world.state_hash();
}

}  // namespace

TEST_CASE("a run of a study is the run that its assignments make, and all variants differ") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    const StudyResult result = study(scene, small_study());
    REQUIRE(names_of_runs(result, StudyRunStatus::ok) ==
            std::vector<std::string>{"scene", "draw_1", "element_smoothed", "step_0.5", "tolerance_0.01", "refine_-1",
                                     "refine_1", "step_0.25"});
    REQUIRE(names_of_runs(result, StudyRunStatus::left_out) == std::vector<std::string>{"refine_2"});
    CHECK(result.runs.back().message.find("more than the budget of 26") != std::string::npos);
    std::vector<std::uint64_t> hashes;
    for (const StudyRun& run : result.runs) {
        // The few contacts are solved to rounding, whatever the tolerance.
        if (run.variant.tolerance == 1) hashes.push_back(run.state_hash);
        if (run.variant.draw == 0 && run.status == StudyRunStatus::ok)
            CHECK(run.state_hash == hash_after(scene, run.assignments));
    }
    std::ranges::sort(hashes);
    CHECK(std::ranges::adjacent_find(hashes) == hashes.end());
    const StudyQuantity& tip = quantity(result, "tip.displacement_z_end");
    CHECK(tip.error > 0);
    CHECK(tip.error == Approx(tip.mesh + tip.step + tip.contact + tip.noise).epsilon(0.01));
}

TEST_CASE("a study has the same bits with one and with three threads") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings = small_study();
    settings.budget = 1e6;  // admits all runs
    settings.seconds = 0.02;
    const StudyResult one = study(scene, settings);
    settings.threads = 3;
    require_same(one, study(scene, settings));
}

TEST_CASE("a stopped study leaves whole files only") {
    const TemporaryFolder folder;
    StudySettings settings = small_study(folder.path() / "runs");
    settings.seconds = 100;  // so long that the first call of go_on comes before the end
    settings.go_on = [](const StudyProgress&) { return false; };
    const StudyResult stopped = study(folder.write("bar.json", bar), settings);
    REQUIRE(stopped.stopped);
    CHECK(stopped.quantities.empty());
    if (!std::filesystem::exists(settings.folder)) return;  // no run had ended
    for (const auto& file : std::filesystem::directory_iterator(settings.folder))
        CHECK(file.path().extension() == ".json");
}

TEST_CASE("a study continues with the runs in its folder, and has the numbers of a whole one") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    const StudySettings settings = small_study(folder.path() / "runs");
    const StudyResult whole = study(scene, settings);
    const auto file_of = [&](const std::string& run) { return settings.folder / ("run_" + run + ".json"); };
    for (const char* lost : {"draw_1", "refine_1", "step_0.25"}) std::filesystem::remove(file_of(lost));
    const auto written = std::filesystem::last_write_time(file_of("scene"));
    require_same(whole, study(scene, settings));
    CHECK(std::filesystem::last_write_time(file_of("scene")) == written);
    CHECK(std::filesystem::exists(file_of("refine_1")));
}

TEST_CASE("a stored run is refused if its columns are shorter than its times") {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "run_step_0.5.json";
    StudyRun run{.variant = {.step = 0.5}, .assignments = {}, .time = {0, 1}};
    run.columns = {{.what = {"tip", "displacement_x", "m"}, .values = {0, 1}}};
    write_run(folder.path(), "inputs", run);
    CHECK(read_run(folder.path(), "inputs", run.variant).run);
    run.columns[0].values.pop_back();
    write_run(folder.path(), "inputs", run);
    const StoredRun stored = read_run(folder.path(), "inputs", run.variant);
    CHECK_FALSE(stored.run);
    CHECK(stored.found == "run_step_0.5.json is no run of a study");
}

TEST_CASE("a stored run without some of the columns is refused, and the others are compared") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings{.threads = 1, .budget = 6, .folder = folder.path() / "runs"};
    settings.seconds = 0.02;
    study(scene, settings);
    const std::filesystem::path file = settings.folder / "run_draw_1.json";
    Json json = read_json(file);
    json["columns"].erase(json["columns"].size() - 1);
    write_file(file, [&](std::ostream& out) { out << json.dump(); });
    const StudyResult result = study(scene, settings);
    CHECK(names_of_runs(result, StudyRunStatus::refused) == std::vector<std::string>{"draw_1"});
    CHECK(names_of_runs(result, StudyRunStatus::ok).size() >= 2);
}

TEST_CASE("a scene that changes while its study runs ends the study") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings{.threads = 1, .budget = 4, .folder = folder.path() / "runs"};
    settings.seconds = 2;  // long enough for a call of go_on between the runs
    bool changed = false;
    settings.go_on = [&](const StudyProgress& progress) {
        if (progress.runs_done > 0 && !changed) {
            std::string other = bar;
            folder.write("bar.json", other.replace(other.find("1e5"), 3, "3e5"));
            changed = true;
        }
        return true;
    };
    CHECK(message_of(scene, settings).find("changed while the study ran") != std::string::npos);
    for (const auto& file : std::filesystem::directory_iterator(settings.folder))
        CHECK(file.path().filename() != "run_element_smoothed.json");
}

TEST_CASE("a study that is made again replaces runs only, and all of them") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings{.threads = 1, .budget = 4, .folder = folder.path() / "runs"};
    settings.seconds = 0.02;
    const StudyResult whole = study(scene, settings);
    Json json = read_json(settings.folder / "run_scene.json");
    json["steps"] = 1;
    const auto write_json = [&](const Json& content) {
        write_file(settings.folder / "run_scene.json", [&](std::ostream& out) { out << content.dump(); });
    };
    write_json(json);
    settings.redo = true;
    CHECK(study(scene, settings).runs[0].steps == whole.runs[0].steps);
    write_json({{"name", "a scene of the user"}});
    CHECK(message_of(scene, settings).find("run_scene.json: study: folder: found a file that is no run of a study") !=
          std::string::npos);
    CHECK(read_json(settings.folder / "run_scene.json").contains("name"));
}

TEST_CASE("a refused run is made again by the next study") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings{.threads = 1, .budget = 4, .folder = folder.path() / "runs"};
    settings.seconds = 0.02;
    study(scene, settings);
    Json json = read_json(settings.folder / "run_draw_1.json");
    json["status"] = "refused";
    write_file(settings.folder / "run_draw_1.json", [&](std::ostream& out) { out << json.dump(); });
    CHECK(study(scene, settings).runs[1].status == StudyRunStatus::ok);
}

TEST_CASE("the runs with other steps have as many steps as their names say") {
    const TemporaryFolder folder;
    std::string implicit = bar;
    implicit.insert(implicit.find("\"pin\""), R"("dynamics": "implicit", )");
    // The steps are shorter than implicit_step, because 0.01 s are no multiple of it.
    StudySettings settings{.probes = {"tip"}, .assignments = {"settings.implicit_step=0.0011"}, .threads = 1};
    settings.seconds = 0.02;
    settings.budget = 15;
    const StudyResult result = study(folder.write("implicit.json", implicit), settings);
    REQUIRE(result.runs[0].steps == 20);
    for (const StudyRun& run : result.runs)
        if (run.status == StudyRunStatus::ok) CHECK(static_cast<Real>(run.steps) * run.variant.step == 20);
}

TEST_CASE("a scene that is written through a symbolic link names the same files") {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "deep" / "real");
    std::filesystem::create_directory_symlink(folder.path() / "deep" / "real", folder.path() / "link");
    folder.write("m.msh", "mesh");
    const std::filesystem::path scene = folder.path() / "link" / "cheapest.json";
    CHECK(path_in_scene(folder.path() / "m.msh", scene) == "../../m.msh");
    CHECK(std::filesystem::equivalent(scene.parent_path() / path_in_scene(folder.path() / "m.msh", scene),
                                      folder.path() / "m.msh"));
}

TEST_CASE("a folder has one study at a time") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings{.threads = 1, .budget = 4, .folder = folder.path() / "runs"};
    settings.seconds = 0.02;
    {
        const OutputLock other = reserve_folder(settings.folder, "other.json");
        CHECK(message_of(scene, settings)
                  .find("runs: study: folder: found an output of process " + std::to_string(getpid())) !=
              std::string::npos);
    }
    CHECK(message_of(scene, settings).empty());
}

TEST_CASE("a file of the user with the name of a lock is refused and stays") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar), lock = folder.write("study.lock", "my notes");
    StudySettings settings{.threads = 1, .budget = 4, .folder = folder.path()};
    settings.seconds = 0.02;
    CHECK(message_of(scene, settings).find("which is not a lock of Skerry") != std::string::npos);
    std::ifstream file(lock);
    std::string kept;
    std::getline(file, kept);
    CHECK(kept == "my notes");
}

TEST_CASE("a study whose runs cannot be written has results all the same") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings{.threads = 1, .budget = 4, .folder = folder.path() / "runs"};
    settings.seconds = 0.02;
    std::filesystem::create_directories(settings.folder);
    std::filesystem::create_symlink(scene / "run.json", settings.folder / "run_draw_1.json");  // `scene` is no folder
    const StudyResult result = study(scene, settings);
    CHECK_FALSE(result.quantities.empty());
    CHECK(std::ranges::any_of(result.sentences, [](const std::string& sentence) {
        return sentence.starts_with("Not all runs could be stored in the folder: ");
    }));
}

TEST_CASE("a study has the stress, slip and numbers of a probe of contacts, and the velocities of the others") {
    const TemporaryFolder folder;
    std::string probed = bar;
    probed.insert(probed.rfind("]}"), R"(, {"name": "end", "body": "arm", "quantity": "contacts",
        "box": {"lower": [0.099, -1, -1], "upper": [1, 1, 1]}})");
    StudySettings settings{.threads = 1, .budget = 4};
    settings.seconds = 0.05;
    const StudyResult result = study(folder.write("bar.json", probed), settings);
    CHECK(quantity(result, "end.largest_von_mises_end").value > 0);
    CHECK(quantity(result, "end.slip_max").value > 0);
    CHECK(quantity(result, "tip.velocity_z_end").value != 0);
    settings.probes = {"end.sticking", "end.sliding"};
    const StudyResult counts = study(folder.write("bar.json", probed), settings);
    CHECK(std::ranges::any_of(counts.quantities, [](const StudyQuantity& q) { return q.value > 0; }));
}

TEST_CASE("two bodies of a study never share a name") {
    const TemporaryFolder folder;
    std::string two = bar;
    const std::string second = R"({"name": "body tip", "shape": {"sphere": {"radius": 0.01}}, "material": "rubber",
        "dynamics": "rigid", "position": [0, 0, 1]}, )";
    two.insert(two.find("[{\"name\": \"arm\"") + 1, second);
    two.replace(two.find("\"arm\""), 5, "\"tip\"");
    two.replace(two.find("\"arm\""), 5, "\"tip\"");
    Scene scene = load_scene(folder.write("two.json", two));
    std::vector<std::string> names;
    for (const StudyColumn& column : StudyRecorder(scene).columns())
        names.push_back(column.what.probe + "." + column.what.quantity);
    std::ranges::sort(names);
    CHECK(std::ranges::adjacent_find(names) == names.end());
}

TEST_CASE("the name of a body with a dot chooses no other body") {
    std::vector<StudyColumn> columns{{.what = {"a.b", "force_x", "N"}}, {.what = {"a.b_1", "force_x", "N"}}};
    choose_columns_by_name({"a.b"}, "scene.json", columns);
    CHECK((columns[0].reported && !columns[1].reported));
    choose_columns_by_name({"a.b_1.force"}, "scene.json", columns);
    CHECK((!columns[0].reported && columns[1].reported));
}

TEST_CASE("runs of another scene are refused unless they may be replaced") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings = small_study(folder.path() / "runs");
    settings.budget = 5;
    settings.seconds = 0.02;
    study(scene, settings);
    settings.seconds = 0.03;
    CHECK(message_of(scene, settings).find("run_scene.json is a run of another scene or with other settings") !=
          std::string::npos);
    settings.seconds = 0.02;
    settings.assignments = {"materials.rubber.E=2e5"};
    CHECK(message_of(scene, settings).find("redo") != std::string::npos);
    settings.redo = true;
    CHECK(study(scene, settings).runs[0].assignments ==
          std::vector<std::string>{"materials.rubber.E=2e5", "seconds=0.02"});
}

TEST_CASE("wrong settings of a study are refused by name") {
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.write("bar.json", bar);
    StudySettings settings;
    settings.error = 0;
    CHECK(message_of(scene, settings).find("error") != std::string::npos);
    settings = {.budget = -1};
    CHECK(message_of(scene, settings).find("budget") != std::string::npos);
    for (const int threads : {-1, 1'000'000'000}) {
        settings = {.threads = threads};
        CHECK(message_of(scene, settings).find("threads: found " + std::to_string(threads)) != std::string::npos);
    }
    settings = {};
    settings.seconds = 0;
    CHECK(message_of(scene, settings).find("seconds") != std::string::npos);
    settings = {};
    settings.probes = {"tpi"};
    CHECK(message_of(scene, settings) ==
          scene.string() +
              ": study: probe: found \"tpi\", expected NAME or NAME.QUANTITY, where NAME is one of \"tip\", \"arm\", "
              "\"energy\" (did you mean \"tip\"?)");
    settings.probes = {"tip.displacement_x"};
    settings.budget = 4;
    for (const StudyQuantity& found : study(scene, settings).quantities)
        CHECK(found.name.starts_with("tip.displacement_x"));
}

TEST_CASE("a scene that fails is reported, and no errors are computed") {
    const TemporaryFolder folder;
    std::string fast = bar;
    fast.insert(fast.find("\"pin\""), "\"velocity\": [0, 0, -1e6], ");
    const StudyResult result = study(folder.write("bar.json", fast), small_study());
    CHECK(result.runs[0].status == StudyRunStatus::failed);
    CHECK(result.quantities.empty());
    REQUIRE(result.sentences.size() == 1);
    CHECK(result.sentences[0].find(result.runs[0].message) != std::string::npos);
}

TEST_CASE("a study names the tractions that act on another area with finer meshes") {
    const TemporaryFolder folder;
    const auto sentences = [&](const std::string& upper) {
        std::string pulled = hanging;
        pulled.insert(pulled.rfind('}'), R"(, "loads": [{"name": "pull", "kind": "traction", "body": "arm",
            "traction": [0, 0, -10], "box": {"lower": [-1, -1, -1], "upper": )" +
                                             upper + "}}]");
        StudySettings settings = small_study();
        settings.seconds = 0.02;
        std::vector<std::string> found = study(folder.write("pulled.json", pulled), settings).sentences;
        std::erase_if(found, [](const std::string& sentence) { return !sentence.starts_with("Load "); });
        return found;
    };
    // The box ends within the faces of the scene and at edges of the finer ones.
    const std::vector<std::string> found = sentences("[0.026, 1, -0.099]");
    REQUIRE(found.size() == 1);
    CHECK(
        found[0].starts_with("Load 'pull' acts on 0.005 m^2 in the scene as it is, and on 0.0075 m^2 with the mesh "
                             "1 level finer"));
    CHECK(sentences("[0.001, 1, -0.099]").empty());
}

TEST_CASE("a perturbation moves free nodes by at most 1e-12 m and leaves held nodes") {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.write("bar.json", bar);
    const auto moved_by = [&](int draw) {
        Scene scene = load_scene(file);
        const BodyHandle body = scene.world.bodies()[0];
        const std::span<const Vec3> nodes = scene.world.positions(body);
        std::vector<Vec3> moved(nodes.begin(), nodes.end());
        perturb_start(draw, scene.world);
        for (std::size_t n = 0; n < moved.size(); ++n) moved[n] = scene.world.positions(body)[n] - moved[n];
        return moved;
    };
    Scene scene = load_scene(file);
    const std::vector<Index> held = scene.world.nodes(scene.world.attachments()[0]);
    const std::vector<Vec3> first = moved_by(1);
    for (std::size_t n = 0; n < first.size(); ++n) {
        CHECK(first[n].norm() <= 1e-12);
        const bool is_held = std::ranges::find(held, static_cast<Index>(n)) != held.end();
        CHECK((first[n].norm() > 0) != is_held);
    }
    CHECK(moved_by(1) == first);
    CHECK(moved_by(2) != first);
    CHECK(moved_by(0) == std::vector<Vec3>(first.size(), Vec3::Zero()));
}

TEST_CASE("the cheapest scene has at most the wanted error against the best value") {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.write("hanging.json", hanging);
    StudySettings settings = small_study();
    settings.error = 0.05;
    settings.probes = {"arm.displacement_z"};
    const StudyResult result = study(file, settings);
    REQUIRE(result.cheapest);
    REQUIRE(result.cheapest->reaches);
    REQUIRE_FALSE(result.cheapest->assignments.empty());
    StudyResult missed = result;
    missed.cheapest->reaches = false;
    CHECK_THROWS_AS(write_cheapest_scene(file, missed, folder.path() / "missed.json"), SceneError);
    CHECK_FALSE(std::filesystem::exists(folder.path() / "missed.json"));
    const std::filesystem::path cheapest = folder.path() / "other" / "cheapest.json";
    write_cheapest_scene(file, result, cheapest);
    CHECK(hash_after(cheapest, {}) == hash_after(file, result.cheapest->assignments));
    const StudyQuantity& sag = quantity(result, "arm.displacement_z_end");
    settings.budget = 3;
    const Real value = quantity(study(cheapest, settings), "arm.displacement_z_end").value;
    CHECK(std::abs(value - sag.best) <= settings.error * sag.scale);
    CHECK(names_of_runs(result, StudyRunStatus::ok) ==
          std::vector<std::string>{"scene", "draw_1", "element_smoothed", "step_0.5", "refine_-1", "refine_1",
                                   "step_0.25"});  // no other tolerance, because nothing touches
    CHECK(std::abs(sag.value - sag.best) <= sag.error);
}

}  // namespace skerry::test::study_test
