#include "engine/study/plan_study.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "engine/scene/run_plan.h"
#include "engine/study/study_columns.h"

namespace skerry {

namespace {

/// Returns a number as JSON with all digits.
std::string number_json(double value) {
    return Json(value).dump();
}

std::vector<ElementKind> elements_of(const SceneFile& file) {
    std::vector<ElementKind> kinds;
    for (const BodyEntry& body : file.bodies) kinds.push_back(body.element);
    return kinds;
}

/// Adds the runs in which all bodies have linear, or all have smoothed elements, unless the scene already has only such
/// elements.
void add_element_runs(const StudiedScene& scene, std::vector<PlannedRun>& plan) {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::smoothed}) {
        std::vector<std::string> changed = scene.assignments;
        for (std::string& assignment : element_assignments(scene.file, scene.path, kind))
            changed.push_back(std::move(assignment));
        if (elements_of(read_scene_file(scene.path, changed)) != elements_of(scene.file))
            plan.push_back({{.element = kind}, kind == ElementKind::linear ? 1.0 : 2.0, {}});
    }
}

/// Largest ratio of the costs of two levels: a level has eight times the tetrahedra of the next coarser one, and
/// explicit bodies take steps half as long.
double most_cost_of_level(const StudiedScene& scene) {
    return scene.has_explicit ? 16 : 8;
}

/// Adds a run with the meshes of `level`. If a mesh lacks this level, the run gets the reason for it and will be left
/// out.
void add_level_run(const StudiedScene& scene, int level, StudyStage stage, std::vector<PlannedRun>& plan) {
    if (scene.levels.meshes.empty()) return;
    plan.push_back({{.refine = level}, std::pow(most_cost_of_level(scene), level), {}, stage});
    if (level < scene.levels.coarsest) plan.back().reason = "no coarser meshes: " + scene.levels.why_not_coarser;
    if (level > scene.levels.finest) plan.back().reason = "no finer meshes: " + scene.levels.why_not_finer;
}

/// Mean step of the implicit bodies [s]. Without explicit bodies it is the mean step of the world. Otherwise a call of
/// advance is divided into equal implicit steps, as few as Settings::implicit_step allows.
Real mean_implicit_step(const StudiedScene& scene, Real mean_step) {
    if (!scene.has_explicit) return mean_step;
    constexpr Real rounding = 1e-9;
    return scene.longest_call / std::ceil(scene.longest_call / scene.settings.implicit_step - rounding);
}

}  // namespace

StudiedScene read_studied_scene(const std::filesystem::path& path, const StudySettings& settings) {
    std::vector<std::string> assignments = settings.assignments;
    if (settings.seconds) assignments.push_back("seconds=" + number_json(*settings.seconds));
    StudiedScene studied{.path = path,
                         .file = read_scene_file(path, assignments),
                         .assignments = assignments,
                         .levels = {},
                         .settings = {}};
    studied.levels = levels_of(studied.file, path);
    SceneOverrides overrides{.threads = 1};
    overrides.assignments = assignments;
    overrides.fill_python = settings.fill_python;
    Scene scene = load_scene(path, overrides);
    studied.settings = scene.world.settings();
    studied.longest_call = plan_run(scene, path, {}).longest_call();
    for (const BodyHandle body : scene.world.bodies())
        studied.has_explicit |= scene.world.dynamics(body) == BodyDynamics::explicit_elastic;
    const StudyRecorder recorder(scene);
    studied.flat = flat_bodies(studied.file, scene.world);
    for (const std::string& name : recorder.bodies()) {
        const auto flat = std::ranges::find(studied.flat, name, &FlatBody::name);
        studied.shape_errors.push_back(flat == studied.flat.end() ? 0 : flat->error());
    }
    std::vector<StudyColumn> columns = recorder.columns();
    choose_columns_by_name(settings.probes, path, columns);
    return studied;
}

std::vector<PlannedRun> plan_study(const StudiedScene& scene) {
    std::vector<PlannedRun> plan{{{}, 1, {}, StudyStage::start}, {{.draw = 1}, 1, {}, StudyStage::start}};
    add_element_runs(scene, plan);
    plan.push_back({{.step = 0.5}, 2, {}});
    constexpr double solving = 1.5;  // cost: the solver takes half of the CPU time; its sweeps double
    plan.push_back({{.tolerance = 0.01}, solving, {}});
    add_level_run(scene, -1, StudyStage::basic, plan);
    if (scene.levels.coarsest <= -2) add_level_run(scene, -2, StudyStage::basic, plan);
    if (!scene.has_explicit) plan.push_back({{.step = 2}, 0.5, {}});
    add_level_run(scene, 1, StudyStage::finer, plan);
    plan.push_back({{.draw = 2}, 1, {}, StudyStage::last});
    plan.push_back({{.step = 0.25}, 4, {}, StudyStage::last});
    if (scene.levels.finest >= 2) add_level_run(scene, 2, StudyStage::last, plan);
    return plan;
}

void predict_levels(const StudiedScene& scene, std::span<const StudyRun> runs, std::span<PlannedRun> plan) {
    const auto seconds = [&](int level) -> double {
        for (std::size_t i = 0; i < runs.size(); ++i)
            if (plan[i].variant == StudyVariant{.refine = level} && plan[i].reason.empty() &&
                runs[i].status == StudyRunStatus::ok)
                return runs[i].cpu_seconds;
        return 0;  // the run was not made
    };
    for (PlannedRun& planned : plan) {
        const int level = planned.variant.refine;
        if (level < 1) continue;
        // On finer meshes, work that does not depend on the mesh takes a smaller share of the time. The cost ratio of
        // two levels therefore grows from level to level, by up to this factor.
        constexpr double growth = 1.5;
        const double made = seconds(level), coarser = seconds(level - 1), coarsest = seconds(level - 2);
        const double most = most_cost_of_level(scene);
        const double ratio = coarsest > 0 ? std::clamp(growth * coarser / coarsest, most / 2, most) : most;
        if (coarser > 0) planned.cost = (made > 0 ? made : ratio * coarser) / runs[0].cpu_seconds;
    }
}

bool gets_all_threads(double cost, double total, int threads) {
    return threads > 1 && cost > total / threads;
}

double wall_time(std::vector<double> costs, int threads) {
    constexpr double efficiency = 0.7;  // share of the speed of one thread that each further thread adds
    std::ranges::sort(costs, std::greater());
    double total = 0, wall = 0;
    for (const double cost : costs) total += cost;
    for (const double cost : costs) {
        if (!gets_all_threads(cost, total, threads)) break;
        wall += cost / (1 + efficiency * (threads - 1));
        total -= cost;
    }
    return wall + total / threads;
}

void keep_to_budget(double budget, int threads, std::size_t first, std::span<PlannedRun> plan) {
    std::map<StudyStage, std::vector<double>> costs;
    for (std::size_t i = 0; i < plan.size(); ++i) {
        if (!plan[i].reason.empty()) continue;
        std::vector<double>& stage = costs[plan[i].stage];
        stage.push_back(plan[i].cost);
        if (i < first) continue;
        double wall = 0;
        for (const auto& [of, together] : costs) wall += wall_time(together, threads);
        if (wall <= budget) continue;
        stage.pop_back();
        plan[i].reason = "with it the study would take about " + short_text(wall) +
                         " times as long as one run, more than the budget of " + short_text(budget) + " (--budget)";
    }
}

std::vector<std::string> variant_assignments(const StudiedScene& scene, const StudyVariant& variant, Real mean_step) {
    std::vector<std::string> assignments = scene.assignments;
    if (variant.step != 1) {
        // A slightly longer step, so that rounding adds no step to a call of advance that lasts a whole number of
        // steps.
        constexpr double slack = 1 + 1e-9;
        assignments.push_back("settings.step_size=" + number_json(mean_step * variant.step * slack));
        if (scene.settings.implicit_step > 0)
            assignments.push_back("settings.implicit_step=" +
                                  number_json(mean_implicit_step(scene, mean_step) * variant.step * slack));
    }
    if (variant.tolerance != 1) {
        assignments.push_back("settings.tolerance=" + number_json(scene.settings.tolerance * variant.tolerance));
        constexpr int more = 10, most = std::numeric_limits<int>::max() / more;
        if (variant.tolerance < 1)
            assignments.push_back("settings.max_iterations=" +
                                  std::to_string(std::min(scene.settings.max_iterations, most) * more));
    }
    const auto add = [&](std::vector<std::string> more) { std::ranges::move(more, std::back_inserter(assignments)); };
    if (variant.refine != 0) add(scene.levels.assignments(variant.refine));
    if (variant.element) add(element_assignments(scene.file, scene.path, *variant.element));
    return assignments;
}

}  // namespace skerry
