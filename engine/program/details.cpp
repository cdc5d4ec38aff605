// Details of a run that --profile prints: step limits, solver statistics, energies and times of the stages.
#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "engine/program/cluster_text.h"
#include "engine/program/dynamics_text.h"
#include "engine/program/number_text.h"
#include "engine/program/run_result.h"
#include "engine/program/start_text.h"

namespace skerry {

namespace {

std::string solver_lines(const RunResult& result) {
    const WorldReport& r = result.report;
    const std::string method = std::string(name_of(result.settings.method)) + ", " +
                               std::string(name_of(result.settings.friction)) + ", " +
                               std::string(name_of(result.settings.contact_regions)) + " regions";
    if (r.solved == 0) return summary_line("solver", method + ": no contacts to solve");
    std::string text =
        summary_line("regions", "mean " + short_number(r.mean_regions, 4) + ", most " +
                                    grouped(static_cast<std::uint64_t>(r.max_regions)) + ", the largest of " +
                                    grouped(static_cast<std::uint64_t>(r.largest_region)) + " contacts");
    text += summary_line("solver", method + ": " + short_number(r.mean_iterations) + " sweeps a region, worst error " +
                                       short_number(r.worst_error) + " (a region of " +
                                       grouped(static_cast<std::uint64_t>(r.worst_region)) + " contacts), " +
                                       grouped(r.unconverged) + " regions not converged");
    text += summary_line(
        "", grouped(r.solved) + " regions solved, " +
                percent(static_cast<double>(r.closed_form) / static_cast<double>(r.solved)) + " in closed form, " +
                percent(static_cast<double>(r.certified) / static_cast<double>(r.solved)) + " by the warm start alone");
    return text;
}

std::string stage_table(const RunResult& result) {
    double total = 0;
    std::size_t width = 0;
    for (const StageReport& stage : result.report.stages) {
        total += stage.seconds;
        width = std::max(width, stage.name.size());
    }
    std::string text;
    for (const StageReport& stage : result.report.stages) {
        char numbers[96];
        std::snprintf(numbers, sizeof numbers, "%6.1f %%  %10s  %9" PRIu64 " runs  %9" PRIu64 " skipped",
                      total > 0 ? 100 * stage.seconds / total : 0, with_unit(stage.seconds, "s").c_str(), stage.runs,
                      stage.skipped);
        text += "    " + stage.name + std::string(width - stage.name.size() + 2, ' ') + numbers + "\n";
    }
    return text;
}

/// Returns one line for each cause that limited the length of at least 1 % of the steps, except for the setting
/// step_size.
std::string limit_lines(const WorldReport& r) {
    const auto why = [](const StepLimitReport& of) -> std::string {
        switch (of.limit) {
            case StepLimit::setting:
                return "step_size";
            case StepLimit::rest:
                return of.body_name + ", stable step at rest";
            case StepLimit::strain:
                return of.body_name + ", stable step of its deformed shape";
            case StepLimit::speed:
                return of.body_name + " deforms too quickly";
            case StepLimit::inversion:
                return of.body_name + " would turn elements inside out";
            case StepLimit::crossing:
                return "surfaces would cross";
        }
        return {};
    };
    std::string text;
    for (const StepLimitReport& of : r.step_limits) {
        const double share = static_cast<double>(of.steps) / static_cast<double>(std::max<std::uint64_t>(r.steps, 1));
        if (share < 0.01 || of.limit == StepLimit::setting) continue;
        text +=
            summary_line(text.empty() ? "step limits" : "",
                         percent(share) + " of steps, " + with_unit(of.seconds / static_cast<double>(of.steps), "s") +
                             " each: " + why(of) + (of.tries > 0 ? " (" + grouped(of.tries) + " tries repeated)" : ""));
    }
    return text;
}

/// Returns lines with the stable step, the number of repeated attempts at a step, and the number of shortened steps.
std::string step_length_lines(const WorldReport& r) {
    std::string text;
    if (!r.stable_step_body.empty())
        text += summary_line("stable step", with_unit(r.stable_step, "s") + " now, of body " + r.stable_step_body);
    if (r.shortened + r.retried + r.limited > 0)
        text += summary_line("step changes", grouped(r.shortened) + " tries repeated with a shorter step, " +
                                                 grouped(r.retried) + " repeated for crossings, " + grouped(r.limited) +
                                                 " steps shorter than step_size, which is too long");
    return text + limit_lines(r);
}

std::string energy_line(const RunResult& result) {
    const Energy& energy = result.report.energy;
    return summary_line("energy", "kinetic " + with_unit(energy.kinetic, "J") + " (at most " +
                                      with_unit(result.peak_kinetic_energy, "J") + "), elastic " +
                                      with_unit(energy.elastic, "J") + ", potential " +
                                      with_unit(energy.potential, "J") + ", dissipated " +
                                      with_unit(energy.dissipated, "J") + ", unexplained " +
                                      with_unit(result.report.energy_error, "J"));
}

}  // namespace

std::string details_of(const RunResult& result) {
    const WorldReport& r = result.report;
    std::string text = summary_line("backend", std::string(name_of(result.settings.backend)));
    if (!r.start_moves.empty()) text += summary_line("start", moves_text(r));
    text += step_length_lines(r);
    for (const std::string& choice : choice_texts(r)) text += summary_line("dynamics", choice);
    if (r.clusters > 0) text += summary_line("clusters", cluster_text(r));
    if (r.large_strain_steps > 0)
        text += summary_line("large strain", grouped(r.large_strain_steps) + " steps of implicit bodies, in " +
                                                 grouped(r.newton_steps) + " steps of Newton's method with " +
                                                 grouped(r.tangent_factors) + " factorisations");
    text += solver_lines(result) + energy_line(result);
    text += summary_line("contact shell", "entered by at most " + with_unit(r.max_gap_violation, "m"));
    text += summary_line("volume ratio", "at least " + short_number(r.worst_volume_ratio) +
                                             (r.worst_volume_body.empty() ? "" : " (" + r.worst_volume_body + ")"));
    text += summary_line("stages", "") + stage_table(result);
    return text + summary_line("state hash", hash_text(result.state_hash));
}

}  // namespace skerry
