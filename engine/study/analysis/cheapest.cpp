#include "engine/study/analysis/cheapest.h"

#include <algorithm>
#include <cmath>

#include "engine/program/number_text.h"

namespace skerry {

namespace {

/// A choice of one setting, and the ratio of its CPU time to that of the scene as it is.
struct Option {
    StudyVariant variant;
    double cost;
};

/// Levels of the mesh that were run, and finer ones whose error and cost are predicted.
constexpr int finer_levels = 2;
constexpr double cost_of_level = 16;  // eight times the elements, twice the steps; used if no finer mesh was run

std::vector<Option> mesh_options(const StudyFamily& family) {
    std::vector<Option> options;
    for (const StudyRun* run : family.comparable) {
        const StudyVariant& v = run->variant;
        if (v.draw == 0 && v.step == 1 && v.tolerance == 1)
            options.push_back({v, run->cpu_seconds / family.scene->cpu_seconds});
    }
    const auto plain = [](const Option& option) { return option.variant.element ? -1000 : option.variant.refine; };
    const Option finest = *std::ranges::max_element(options, {}, plain);
    const auto before = std::ranges::find(options, finest.variant.refine - 1, plain);
    if (options.size() == 1) return options;  // the meshes of the scene have no levels
    const double growth = before == options.end() ? cost_of_level : std::max(1.0, finest.cost / before->cost);
    for (int level = 1; level <= finer_levels; ++level)
        options.push_back({{.refine = finest.variant.refine + level}, finest.cost * std::pow(growth, level)});
    return options;
}

/// Options of the steps, with `member` StudyVariant::step, or of the tolerances.
std::vector<Option> factor_options(const StudyFamily& family, Real StudyVariant::*member) {
    std::vector<Option> options;
    for (const StudyRun* run : family.comparable) {
        StudyVariant rest = run->variant;
        rest.*member = 1;
        if (rest.is_scene()) options.push_back({run->variant, run->cpu_seconds / family.scene->cpu_seconds});
    }
    return options;
}

bool counts(const MeasuredQuantity& quantity) {
    const StudyQuantity& r = quantity.result;
    return (r.verdict == StudyVerdict::known || r.verdict == StudyVerdict::irregular) && std::isfinite(r.error) &&
           r.scale > 0;
}

}  // namespace

std::optional<CheapestSettings> cheapest_settings(const StudyFamily& family,
                                                  std::span<const MeasuredQuantity> quantities, double wanted) {
    if (std::ranges::none_of(quantities, counts)) return {};
    CheapestSettings best;
    const StudyQuantity* limiting = nullptr;
    const auto consider = [&](const Option& mesh, const Option& step, const Option& tolerance) {
        CheapestSettings found{.variant = mesh.variant};
        found.variant.step = step.variant.step;
        found.variant.tolerance = tolerance.variant.tolerance;
        found.cpu_seconds = family.scene->cpu_seconds * mesh.cost * step.cost * tolerance.cost;
        const StudyQuantity* worst = nullptr;
        for (const MeasuredQuantity& quantity : quantities) {
            if (!counts(quantity)) continue;
            const Real error = error_with(quantity, found.variant) / quantity.result.scale;
            if (!(error <= found.error)) {
                found.error = std::isnan(error) ? infinity : error;
                worst = &quantity.result;
            }
        }
        found.reaches = found.error <= wanted;
        const bool better = !limiting                       ? true
                            : found.reaches != best.reaches ? found.reaches
                            : found.reaches                 ? found.cpu_seconds < best.cpu_seconds
                                                            : found.error < best.error;
        if (!better) return;
        best = found;
        limiting = worst ? worst : &std::ranges::find_if(quantities, counts)->result;
    };
    const std::vector<Option> steps = factor_options(family, &StudyVariant::step);
    const std::vector<Option> tolerances = factor_options(family, &StudyVariant::tolerance);
    for (const Option& mesh : mesh_options(family))
        for (const Option& step : steps)
            for (const Option& tolerance : tolerances) consider(mesh, step, tolerance);
    best.sentence = best.reaches ? "the largest error is that of " + limiting->name
                                 : "no settings reach " + percent(wanted) + ": with the best ones " + limiting->name +
                                       " still has an error of " + percent(best.error);
    return best;
}

}  // namespace skerry
