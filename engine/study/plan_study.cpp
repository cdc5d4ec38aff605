#include "engine/study/plan_study.h"

#include <algorithm>
#include <functional>

#include "engine/scene/run_plan.h"
#include "engine/study/run_file.h"
#include "engine/study/study_columns.h"

namespace skerry {

namespace {

/// Returns a number as JSON with all digits.
std::string number_json(double value) {
    return Json(value).dump();
}

/// True if the element kind of the body matters, and an assignment can change it. Bodies of included scenes belong to
/// another file.
bool has_elements(const StudiedScene& scene, const BodyEntry& body) {
    return body.mesh && body.dynamics != BodyDynamics::rigid && body.place.file() == scene.path;
}

/// Adds the runs in which all bodies have linear, or all have smoothed elements, unless they have them anyway.
void add_element_runs(const StudiedScene& scene, std::vector<PlannedRun>& plan) {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::smoothed})
        if (std::ranges::any_of(scene.file.bodies, [&](const BodyEntry& body) {
                return has_elements(scene, body) && body.element != kind;
            }))
            plan.push_back({{.element = kind}, kind == ElementKind::linear ? 1.0 : 2.0, {}});
}

}  // namespace

StudiedScene read_studied_scene(const std::filesystem::path& path, const StudySettings& settings) {
    StudiedScene studied{.path = path,
                         .file = read_scene_file(path, settings.assignments),
                         .assignments = settings.assignments,
                         .settings = {}};
    SceneOverrides overrides{.threads = 1};
    overrides.assignments = settings.assignments;
    overrides.fill_python = settings.fill_python;
    Scene scene = load_scene(path, overrides);
    studied.settings = scene.world.settings();
    studied.longest_call = plan_run(scene, path, settings.seconds).longest_call();
    for (const BodyHandle body : scene.world.bodies()) {
        studied.has_explicit |= scene.world.dynamics(body) == BodyDynamics::explicit_elastic;
        studied.has_implicit |= scene.world.dynamics(body) == BodyDynamics::implicit_elastic;
    }
    std::vector<StudyColumn> columns = StudyRecorder(scene).columns();
    choose_columns(settings.probes, path, columns);
    return studied;
}

std::vector<PlannedRun> plan_study(const StudiedScene& scene) {
    std::vector<PlannedRun> plan{{{}, 1, {}}, {{.draw = 1}, 1, {}}, {{.draw = 2}, 1, {}}};
    add_element_runs(scene, plan);
    plan.push_back({{.step = 0.5}, 2, {}});
    constexpr double solving = 1.5;  // a contact solver needs about twice the sweeps, which take half of the time
    plan.push_back({{.tolerance = 0.01}, solving, {}});
    if (!scene.has_explicit) plan.push_back({{.step = 2}, 0.5, {}});
    plan.push_back({{.step = 0.25}, 4, {}});
    return plan;
}

bool gets_all_threads(double cost, double total, int threads) {
    return threads > 1 && cost > total / threads;
}

double wall_time(std::vector<double> costs, int threads) {
    constexpr double efficiency = 0.7;  // gain of each further thread of a run
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

void keep_to_budget(double budget, int threads, std::vector<PlannedRun>& plan) {
    std::vector<double> first, second;
    for (std::size_t i = 0; i < plan.size(); ++i) {
        std::vector<double>& phase = i < independent_runs ? first : second;
        phase.push_back(plan[i].cost);
        const double wall = wall_time(first, threads) + wall_time(second, threads);
        if (i == 0 || wall <= budget) continue;
        phase.pop_back();
        plan[i].reason = "with it the study would take about " + short_text(wall) +
                         " times as long as one run, more than the budget of " + short_text(budget);
    }
}

std::vector<std::string> variant_assignments(const StudiedScene& scene, const StudyVariant& variant, Real mean_step) {
    std::vector<std::string> assignments = scene.assignments;
    if (variant.step != 1) {
        constexpr double slack = 1 + 1e-9;  // a call of advance that is a whole number of steps must stay one
        assignments.push_back("settings.step_size=" + number_json(mean_step * variant.step * slack));
        if (scene.settings.implicit_step > 0)
            assignments.push_back("settings.implicit_step=" +
                                  number_json(scene.settings.implicit_step * variant.step * slack));
    }
    if (variant.tolerance != 1) {
        assignments.push_back("settings.tolerance=" + number_json(scene.settings.tolerance * variant.tolerance));
        constexpr int more = 10;
        if (variant.tolerance < 1)
            assignments.push_back("settings.max_iterations=" + std::to_string(scene.settings.max_iterations * more));
    }
    if (variant.element)
        for (const BodyEntry& body : scene.file.bodies)
            if (has_elements(scene, body))
                assignments.push_back(body.place.path() + ".element=" + std::string(name_of(*variant.element)));
    return assignments;
}

}  // namespace skerry
