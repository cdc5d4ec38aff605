#include "engine/study/analysis/analyse.h"

#include <algorithm>
#include <cmath>

#include "engine/output/number_text.h"
#include "engine/study/analysis/cheapest.h"

namespace skerry {

namespace {

std::string chaos_text(const StudyResult& result) {
    std::string text = "Runs begun 1e-12 m apart agree until " + short_number(result.agree_until) + " s";
    if (result.growth_rate > 0)
        text += "; small differences grow tenfold every " + duration_text(std::log(10) / result.growth_rate);
    return text +
           ". After that no run, however fine, tells where a single body is: read the values named _agreed, and "
           "the statistics of all bodies.";
}

/// Names the runs that ended well and cannot be compared with the scene as it is.
void add_run_sentences(const StudyFamily& family, std::vector<std::string>& sentences) {
    for (std::size_t i = 0; i < family.all->size(); ++i) {
        const StudyRun& run = (*family.all)[i];
        if (run.status == StudyRunStatus::ok && std::ranges::find(family.comparable, &run) == family.comparable.end())
            sentences.push_back("Run " + std::to_string(i) +
                                " is not used: its rows differ from those of the scene as it is.");
    }
}

}  // namespace

StudyResult analyse(std::vector<StudyRun> runs, const StudySettings& settings) {
    StudyResult result;
    result.wanted_error = settings.error;
    result.runs = std::move(runs);
    const StudyFamily family(result.runs);
    const std::vector<Real> scales = column_scales(family);
    const PerturbedRuns perturbed = family.perturbed();
    std::vector<Real> until;
    for (std::size_t column = 0; column < scales.size(); ++column) {
        until.push_back(agree_until(perturbed, column, scales[column]));
        if (family.scene->columns[column].what.unit == "m" && !is_statistic(family.scene->columns[column]))
            result.agree_until = std::min(result.agree_until, until.back());
    }
    result.growth_rate = growth_rate(perturbed, scales);
    const bool chaotic = result.agree_until < family.scene->time.back();
    if (chaotic) result.sentences.push_back(chaos_text(result));
    const bool reports_bodies = std::ranges::any_of(family.scene->columns, [](const StudyColumn& column) {
        return column.reported && column.what.unit == "m" && !is_statistic(column);
    });
    std::vector<MeasuredQuantity> measured;
    result.bands.resize(scales.size());
    for (std::size_t column = 0; column < scales.size(); ++column) {
        const StudyColumn& what = family.scene->columns[column];
        if (!what.reported || (is_statistic(what) && !chaotic && reports_bodies)) continue;
        // Values below the effect of 1e-12 m or of rounding mean nothing, as the stress of a body that flies freely.
        if (settings.probes.empty() && what.what.unit != "m" && family.sizes[column] < agreement_share * scales[column])
            continue;
        result.bands[column] = error_band(family, column, scales[column], until[column]);
        for (const StudyFigure figure : figures_of(family, column, until[column], scales[column]))
            measured.push_back(measure(family, column, figure, scales[column], until[column], settings.error));
    }
    for (const MeasuredQuantity& quantity : measured) result.quantities.push_back(quantity.result);
    result.cheapest = cheapest_settings(family, measured, settings.error);
    if (!result.cheapest)
        result.sentences.emplace_back("No cheapest settings can be named, because no quantity has a known error.");
    add_run_sentences(family, result.sentences);
    return result;
}

}  // namespace skerry
