// Details of a run that --profile prints: step limits, solver statistics, energies and times of the stages.
#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "engine/output/number_text.h"
#include "engine/program/cluster_text.h"
#include "engine/program/dynamics_text.h"
#include "engine/program/run_result.h"

namespace skerry {

namespace {

std::string solver_lines(const RunResult& result) {
    const WorldReport& r = result.report;
    const std::string method = std::string(name_of(result.settings.method)) + ", " +
                               std::string(name_of(result.settings.friction)) + ", " +
                               std::string(name_of(result.settings.contact_regions)) + " contact regions";
    if (r.solved == 0) return summary_line("solver", method + ": no contacts to solve");
    std::string text =
        summary_line("regions", short_text(r.mean_regions, 4) + " per step on average, at most " +
                                    grouped(static_cast<std::uint64_t>(r.max_regions)) + ", the largest with " +
                                    grouped(static_cast<std::uint64_t>(r.largest_region)) + " contacts");
    text += summary_line("solver", method + ": " + short_text(r.mean_iterations) +
                                       " sweeps per region on average, largest error " + short_text(r.worst_error) +
                                       " (in a region of " + grouped(static_cast<std::uint64_t>(r.worst_region)) +
                                       " contacts), " + grouped(r.unconverged) + " regions not converged");
    text += summary_line("", grouped(r.solved) + " regions solved, " +
                                 percent(static_cast<double>(r.closed_form) / static_cast<double>(r.solved)) +
                                 " in closed form, " +
                                 percent(static_cast<double>(r.certified) / static_cast<double>(r.solved)) +
                                 " by the warm start without any sweep");
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

/// Returns one line for each cause that limited the length of at least 1 % of the steps. The setting step_size does not
/// count as a cause.
std::string limit_lines(const WorldReport& r) {
    const auto cause = [](const StepLimitReport& limit_report) -> std::string {
        switch (limit_report.limit) {
            case StepLimit::setting:
                return "step_size";
            case StepLimit::rest:
                return "the stable step of " + limit_report.body_name + " at rest";
            case StepLimit::strain:
                return "the stable step of " + limit_report.body_name + " in its deformed shape";
            case StepLimit::speed:
                return "fast deformation or rotation of " + limit_report.body_name;
            case StepLimit::inversion:
                return "elements of " + limit_report.body_name + " that would turn inside out";
            case StepLimit::crossing:
                return "surfaces that would cross";
        }
        return {};
    };
    std::string text;
    for (const StepLimitReport& limit_report : r.step_limits) {
        const double fraction =
            static_cast<double>(limit_report.steps) / static_cast<double>(std::max<std::uint64_t>(r.steps, 1));
        if (fraction < 0.01 || limit_report.limit == StepLimit::setting) continue;
        text += summary_line(
            text.empty() ? "step limits" : "",
            percent(fraction) + " of the steps, " +
                with_unit(limit_report.seconds / static_cast<double>(limit_report.steps), "s") +
                " long on average, limited by " + cause(limit_report) +
                (limit_report.tries > 0 ? " (" + grouped(limit_report.tries) + " discarded attempts)" : ""));
    }
    return text;
}

/// Returns lines with the stable step, the number of repeated attempts at a step, the number of shortened steps, and
/// the causes that limited the steps.
std::string step_length_lines(const WorldReport& r) {
    std::string text;
    if (!r.stable_step_body.empty())
        text += summary_line("stable step", with_unit(r.stable_step, "s") + " at the end, the stable step of body " +
                                                r.stable_step_body);
    if (r.shortened + r.retried + r.limited > 0)
        text += summary_line("step changes",
                             grouped(r.shortened) + " attempts repeated with a shorter step, " + grouped(r.retried) +
                                 " attempts repeated because surfaces would have crossed, " + grouped(r.limited) +
                                 " steps shorter than step_size, because step_size exceeds the stable step");
    return text + limit_lines(r);
}

std::string energy_line(const RunResult& result) {
    const Energy& energy = result.report.energy;
    const Real work = result.report.plastic_work;
    const std::string plastic = work > 0 ? " (plastic work " + with_unit(work, "J") + ")" : "";
    return summary_line("energy", "kinetic " + with_unit(energy.kinetic, "J") + " (largest value " +
                                      with_unit(result.peak_kinetic_energy, "J") + "), elastic " +
                                      with_unit(energy.elastic, "J") + ", potential " +
                                      with_unit(energy.potential, "J") + ", dissipated " +
                                      with_unit(energy.dissipated, "J") + plastic + ", error of the energy balance " +
                                      with_unit(result.report.energy_error, "J") +
                                      (result.report.distrust().empty() ? "" : "; not to be trusted"));
}

}  // namespace

std::string details_of(const RunResult& result) {
    const WorldReport& r = result.report;
    std::string text = summary_line("backend", std::string(name_of(result.settings.backend)));
    text += step_length_lines(r);
    for (const std::string& choice : choice_texts(r)) text += summary_line("dynamics", choice);
    if (r.clusters > 0) text += summary_line("clusters", cluster_text(r));
    if (r.large_strain_steps > 0)
        text += summary_line("large strain", grouped(r.large_strain_steps) +
                                                 " steps of implicit bodies at large strain, solved in " +
                                                 grouped(r.newton_steps) + " iterations of Newton's method with " +
                                                 grouped(r.tangent_factors) + " matrix factorisations");
    text += solver_lines(result) + energy_line(result);
    text += summary_line("contact shell", "surfaces came closer than the contact distance by at most " +
                                              with_unit(r.max_gap_violation, "m"));
    text += summary_line(
        "volume ratio", "current over rest volume of the most compressed element: " + short_text(r.worst_volume_ratio) +
                            (r.worst_volume_body.empty() ? "" : " (" + r.worst_volume_body + ")"));
    text += summary_line("stages", "") + stage_table(result);
    return text + summary_line("state hash", hash_text(result.state_hash));
}

}  // namespace skerry
