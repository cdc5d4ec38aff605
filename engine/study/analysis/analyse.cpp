#include "engine/study/analysis/analyse.h"

#include <algorithm>
#include <cmath>

#include "engine/output/number_text.h"
#include "engine/study/analysis/cheapest.h"

namespace skerry {

namespace {

std::string chaos_text(const StudyResult& result) {
    std::string text = "Runs whose starts differ by 1e-12 m agree until " + short_text(result.agree_until) + " s";
    if (result.growth_rate > 0)
        text += "; small differences grow tenfold every " + duration_text(std::log(10) / result.growth_rate);
    return text +
           ". After that, no run predicts the position of a single body, however fine its mesh and steps: use the "
           "values "
           "named _agreed, and the statistics of all bodies.";
}

/// Adds a sentence for each run that ended well but cannot be compared with the run of the scene as it is.
void add_run_sentences(const StudyFamily& family, std::vector<std::string>& sentences) {
    for (std::size_t i = 0; i < family.all->size(); ++i) {
        const StudyRun& run = (*family.all)[i];
        if (run.status == StudyRunStatus::ok && std::ranges::find(family.comparable, &run) == family.comparable.end())
            sentences.push_back(
                "Run " + std::to_string(i) +
                " is not used: its columns or its number of rows differ from those of the scene as it is.");
    }
}

/// Results of measure_all(): the measured quantities, and properties of the columns from which they are computed.
struct Measured {
    // by column: scale (column_scales()), and time until which perturbed runs agree [s]
    std::vector<Real> scales, until;
    Real agree_until = infinity;         // StudyResult::agree_until
    std::vector<std::size_t> columns{};  // columns with error bars
    std::vector<MeasuredQuantity> quantities{};

    bool is_chaotic(const StudyFamily& family) const { return agree_until < family.scene->time.back(); }
};

Measured measure_all(const StudyFamily& family, const StudySettings& settings) {
    Measured found{.scales = column_scales(family), .until = {}};
    const PerturbedRuns perturbed = family.perturbed();
    const auto is_place = [](const StudyColumn& column) { return column.what.unit == "m" && !column.is_statistic; };
    for (std::size_t column = 0; column < found.scales.size(); ++column) {
        found.until.push_back(agree_until(perturbed, column, found.scales[column]));
        if (is_place(family.scene->columns[column]))
            found.agree_until = std::min(found.agree_until, found.until.back());
    }
    const bool reports_bodies = std::ranges::any_of(
        family.scene->columns, [&](const StudyColumn& column) { return column.reported && is_place(column); });
    for (std::size_t column = 0; column < found.scales.size(); ++column) {
        const StudyColumn& what = family.scene->columns[column];
        if (!what.reported || (what.is_statistic && !found.is_chaotic(family) && reports_bodies)) continue;
        // Values below the effect of rounding, or of the perturbation of the start by 1e-12 m, are noise. An example is
        // the stress of a body in free flight.
        if (settings.probes.empty() && what.what.unit != "m" &&
            family.sizes[column] < agreement_share * found.scales[column])
            continue;
        found.columns.push_back(column);
        const Real scale = found.scales[column], until = found.until[column];
        for (const StudyFigure figure : figures_of(family, column, until, scale))
            found.quantities.push_back(measure(family, column, figure, scale, until, settings.error));
    }
    return found;
}

}  // namespace

StudyResult analyse(std::vector<StudyRun> runs, const StudySettings& settings) {
    StudyResult result;
    result.wanted_error = settings.error;
    result.runs = std::move(runs);
    const StudyFamily family(result.runs);
    const Measured measured = measure_all(family, settings);
    result.agree_until = measured.agree_until;
    result.growth_rate = growth_rate(family.perturbed(), measured.scales);
    if (measured.is_chaotic(family)) result.sentences.push_back(chaos_text(result));
    result.bands.resize(measured.scales.size());
    for (const std::size_t column : measured.columns)
        result.bands[column] = error_band(family, column, measured.scales[column], measured.until[column]);
    for (const MeasuredQuantity& quantity : measured.quantities) result.quantities.push_back(quantity.result);
    result.cheapest = cheapest_settings(family, measured.quantities, settings.error);
    if (!result.cheapest)
        result.sentences.emplace_back("No cheapest settings can be named, because no quantity has a known error.");
    add_run_sentences(family, result.sentences);
    return result;
}

OpenParts open_parts(const std::vector<StudyRun>& runs, const StudySettings& settings) {
    // Noise below `noise_share` of the wanted error is ignored. So is a step error below `step_share` of the wanted
    // error or below `share_of_bar` of the error bar.
    constexpr Real noise_share = 0.01, step_share = 0.1, share_of_bar = 0.1;
    const StudyFamily family(runs);
    const Measured measured = measure_all(family, settings);
    OpenParts open{.step = false, .noise = measured.is_chaotic(family)};
    for (const MeasuredQuantity& quantity : measured.quantities) {
        const StudyQuantity& r = quantity.result;
        const Real accepted = settings.error * r.scale;
        open.noise |= r.noise > noise_share * accepted;
        // A run with a third step length is worth while: with only two, the estimate of the step error assumes order 1,
        // and a third one may show a smaller error.
        open.step |= r.step > step_share * accepted && !(r.step < share_of_bar * r.error);
    }
    return open;
}

}  // namespace skerry
