#include "engine/study/analysis/cheapest.h"

#include <algorithm>
#include <cmath>

#include "engine/output/number_text.h"

namespace skerry {

namespace {

/// A possible mesh, step length or tolerance. `cost`: CPU time with it, divided by the CPU time of the unchanged scene.
struct Option {
    StudyVariant variant;
    double cost;
    bool predicted = false;  // true for a finer mesh that no run has used
};

/// Error and cost are predicted for this number of mesh levels beyond the finest one of the runs.
constexpr int finer_levels = 2;
// CPU time of a mesh level divided by that of the next coarser level: 8 x elements, 2 x steps; used if no ratio was
// measured
constexpr double cost_of_level = 16;

std::vector<Option> mesh_options(const StudyFamily& family) {
    std::vector<Option> options;
    for (const StudyRun* run : family.comparable) {
        const StudyVariant& v = run->variant;
        if (v.draw == 0 && v.step == 1 && v.tolerance == 1)
            options.push_back({v, std::max(run->cpu_seconds / family.scene->cpu_seconds, v.refine > 0 ? 1.0 : 0.0)});
    }
    const auto plain = [](const Option& option) { return option.variant.element ? -1000 : option.variant.refine; };
    const Option finest = *std::ranges::max_element(options, {}, plain);
    const auto before = std::ranges::find(options, finest.variant.refine - 1, plain);
    if (options.size() == 1) return options;  // no run used another mesh
    const double growth = before == options.end() ? cost_of_level : std::max(1.0, finest.cost / before->cost);
    for (int level = 1; level <= finer_levels; ++level)
        options.push_back({{.refine = finest.variant.refine + level}, finest.cost * std::pow(growth, level), true});
    return options;
}

/// Options of the step length (`member`: StudyVariant::step) or of the tolerance (StudyVariant::tolerance).
std::vector<Option> factor_options(const StudyFamily& family, Real StudyVariant::*member) {
    std::vector<Option> options;
    for (const StudyRun* run : family.comparable) {
        StudyVariant rest = run->variant;
        rest.*member = 1;
        if (!rest.is_scene()) continue;
        // Measured times scatter. Shorter steps and lower tolerances are never assumed to be cheaper than the scene as
        // it is.
        const double cost = run->cpu_seconds / family.scene->cpu_seconds;
        options.push_back({run->variant, run->variant.*member < 1 ? std::max(cost, 1.0) : cost});
    }
    return options;
}

bool has_usable_error(const MeasuredQuantity& quantity) {
    const StudyQuantity& r = quantity.result;
    return (r.verdict == StudyVerdict::known || r.verdict == StudyVerdict::irregular) && std::isfinite(r.error) &&
           r.scale > 0;
}

/// Settings with their predicted largest error. `worst`: name of the quantity with this error.
/// If no settings reach the wanted error, the settings nearest to it are proposed, but neither linear elements nor
/// meshes that no run has used (see `may_be_nearest`).
struct Prediction {
    CheapestSettings settings;
    std::string worst{};
    // `within`: number of quantities whose error is at most the wanted error. `counted`: number of quantities with an
    // error, that is, for which counts() is true.
    std::size_t within = 0, counted = 0;
    // true if these settings may be proposed when no settings reach the wanted error
    bool may_be_nearest = true;
};

Prediction predict(const StudyFamily& family, std::span<const MeasuredQuantity> quantities, const Option& mesh,
                   const Option& step, const Option& tolerance, double wanted_error) {
    Prediction found;
    found.may_be_nearest = !mesh.predicted && mesh.variant.element != ElementKind::linear;
    CheapestSettings& settings = found.settings;
    settings.variant = mesh.variant;
    settings.variant.step = step.variant.step;
    settings.variant.tolerance = tolerance.variant.tolerance;
    settings.cpu_seconds = family.scene->cpu_seconds * mesh.cost * step.cost * tolerance.cost;
    for (const MeasuredQuantity& quantity : quantities) {
        if (!has_usable_error(quantity)) continue;
        Real error = error_with(quantity, settings.variant) / quantity.result.scale;
        if (std::isnan(error)) error = infinity;
        ++found.counted;
        if (error <= wanted_error) ++found.within;
        if (!found.worst.empty() && error <= settings.error) continue;
        settings.error = error;
        found.worst = quantity.result.name;
    }
    return found;
}

}  // namespace

std::optional<CheapestSettings> cheapest_settings(const StudyFamily& family,
                                                  std::span<const MeasuredQuantity> quantities, double wanted_error) {
    if (std::ranges::none_of(quantities, has_usable_error)) return {};
    const std::vector<Option> meshes = mesh_options(family), steps = factor_options(family, &StudyVariant::step),
                              tolerances = factor_options(family, &StudyVariant::tolerance);
    std::vector<Prediction> predictions;
    double least_error = infinity, least_measured = infinity;
    for (const Option& mesh : meshes)
        for (const Option& step : steps)
            for (const Option& tolerance : tolerances) {
                predictions.push_back(predict(family, quantities, mesh, step, tolerance, wanted_error));
                const double error = predictions.back().settings.error;
                least_error = std::min(least_error, error);
                if (predictions.back().may_be_nearest) least_measured = std::min(least_measured, error);
            }
    // If no settings reach the wanted error, the cheapest settings with an error of at most this factor times the
    // smallest error are proposed. Only settings with `may_be_nearest` are considered then.
    constexpr double nearly = 1.1;
    const bool reaches = least_error <= wanted_error;
    const double target = reaches ? wanted_error : nearly * least_measured;
    const Prediction* best = nullptr;
    for (const Prediction& prediction : predictions)
        if (prediction.settings.error <= target && (reaches || prediction.may_be_nearest) &&
            (!best || prediction.settings.cpu_seconds < best->settings.cpu_seconds))
            best = &prediction;
    CheapestSettings result = best->settings;
    result.reaches = reaches;
    result.sentence = reaches ? "the largest error is that of " + best->worst
                              : "no settings reach " + percent(wanted_error) + ", because " + best->worst +
                                    " still has an error of " + percent(result.error) + "; " +
                                    std::to_string(best->within) + " of " + std::to_string(best->counted) +
                                    " quantities are within it";
    if (const std::size_t others = quantities.size() - best->counted; others > 0)
        result.sentence += "; " + std::to_string(others) + (others > 1 ? " quantities" : " quantity") +
                           " with another verdict than known or irregular do" + (others > 1 ? "" : "es") + " not count";
    return result;
}

}  // namespace skerry
