#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>

#include "engine/program/cluster_text.h"
#include "engine/program/dynamics_text.h"
#include "engine/program/number_text.h"
#include "engine/program/run_result.h"
#include "engine/program/start_text.h"

namespace skerry {

namespace {

constexpr std::size_t label_width = 14;

std::string line(const std::string& label, const std::string& text) {
    return "  " + label + std::string(label.size() < label_width ? label_width - label.size() : 1, ' ') + text + "\n";
}

std::string solver_lines(const RunResult& result) {
    const WorldReport& r = result.report;
    const std::string method = std::string(name_of(result.settings.method)) + ", " +
                               std::string(name_of(result.settings.friction)) + ", " +
                               std::string(name_of(result.settings.contact_regions)) + " regions";
    std::string text = line("contacts", "mean " + short_number(r.mean_contacts, 4) + ", most " +
                                            grouped(static_cast<std::uint64_t>(r.max_contacts)));
    text += line("regions", "mean " + short_number(r.mean_regions, 4) + ", most " +
                                grouped(static_cast<std::uint64_t>(r.max_regions)) + ", the largest of " +
                                grouped(static_cast<std::uint64_t>(r.largest_region)) + " contacts");
    text += line("solver", method + ": " + short_number(r.mean_iterations) + " sweeps a region, worst error " +
                               short_number(r.worst_error) + " (a region of " +
                               grouped(static_cast<std::uint64_t>(r.worst_region)) + " contacts), " +
                               grouped(r.unconverged) + " regions not converged");
    if (r.solved > 0)
        text += line("", grouped(r.solved) + " regions solved, " +
                             percent(static_cast<double>(r.closed_form) / static_cast<double>(r.solved)) +
                             " in closed form, " +
                             percent(static_cast<double>(r.certified) / static_cast<double>(r.solved)) +
                             " by the warm start alone");
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

/// Limits that shortened the steps, listed down to a hundredth of the steps.
std::string limit_lines(const WorldReport& r) {
    const auto why = [](const StepLimitReport& of) -> std::string {
        switch (of.limit) {
            case StepLimit::setting:
                return "as step_size says";
            case StepLimit::rest:
                return of.body_name + " as it is at rest";
            case StepLimit::strain:
                return of.body_name + " as it is deformed";
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
        text += line(text.empty() ? "step limits" : "",
                     percent(share) + " of steps, " + with_unit(of.seconds / static_cast<double>(of.steps), "s") +
                         " each: " + why(of) + (of.tries > 0 ? " (" + grouped(of.tries) + " tries given up)" : ""));
    }
    return text;
}

std::string probe_lines(const RunResult& result) {
    std::string text;
    for (const ProbeRecord& probe : result.probes)
        text += line(text.empty() ? "probes" : "",
                     probe.name + ": sticks " + with_unit(probe.stick_time, "s") + ", slides " +
                         with_unit(probe.slide_time, "s") + " (" + with_unit(probe.slide_alone_time, "s") +
                         " of it alone), off " + with_unit(probe.open_time, "s") + ", changes " +
                         std::to_string(probe.changes) + " times, slips " + with_unit(probe.slip_distance, "m") +
                         ", at most " + with_unit(probe.max_slip, "m/s") + "; von Mises stress at most " +
                         with_unit(probe.max_von_mises, "Pa"));
    return text;
}

/// Errors of the energy and momentum balance, and the warnings.
std::string trust_lines(const RunResult& result) {
    const WorldReport& r = result.report;
    std::string text = line(
        "balance", "energy adds up to " + percent(r.energy_error_share) + " (" + with_unit(r.energy_error, "J") + ")" +
                       (std::isnan(r.momentum_error) ? ", momentum not known: a body that is damped is held"
                                                     : ", momentum to " + percent(r.momentum_error_share)));
    for (const std::string& doubt : doubts_of(result)) text += line("DOUBT", doubt);
    return text;
}

}  // namespace

std::string summary_of(const RunResult& result) {
    const WorldReport& r = result.report;
    const double wall = result.seconds_wall;
    std::string text =
        result.scene + ": " + short_number(result.seconds_simulated, 4) + " s simulated in " + with_unit(wall, "s");
    if (wall > 0) text += ", " + short_number(result.seconds_simulated / wall) + " times real time";
    text += "\n";
    text += line("status", result.status);
    if (result.restarted_at) text += line("restarted", "at " + with_unit(*result.restarted_at, "s"));
    text +=
        line("threads", std::to_string(result.threads) + " (" + std::string(name_of(result.settings.backend)) + ")");
    text += line("bodies", grouped(r.bodies) + ", " + grouped(r.nodes) + " nodes, " + grouped(r.elements) +
                               " tetrahedra, " + grouped(r.colliders) + " colliders" +
                               (r.asleep > 0 ? ", " + grouped(r.asleep) + " at rest" : ""));
    if (r.steps > 0)
        text +=
            line("steps",
                 grouped(r.steps) + " of " + with_unit(result.seconds_simulated / static_cast<double>(r.steps), "s") +
                     (r.stable_step_body.empty()
                          ? std::string()
                          : ", stable up to " + with_unit(r.stable_step, "s") + " (" + r.stable_step_body + ")") +
                     (r.shortened > 0 ? ", shortened " + grouped(r.shortened) + " times" : "") +
                     (r.retried > 0 ? ", tried again " + grouped(r.retried) + " times for crossings" : "") +
                     (r.limited > 0 ? ", " + grouped(r.limited) + " of them shorter than step_size, which is too long"
                                    : ""));
    if (!r.start_moves.empty()) text += line("start", moves_text(r));
    text += limit_lines(r);
    for (const std::string& choice : choice_texts(r)) text += line("dynamics", choice);
    if (r.clusters > 0) text += line("clusters", cluster_text(r));
    if (r.large_strain_steps > 0)
        text += line("large strain", grouped(r.large_strain_steps) + " steps of implicit bodies, in " +
                                         grouped(r.newton_steps) + " of Newton's method with " +
                                         grouped(r.tangent_factors) + " factors");
    text += solver_lines(result);
    text += line("energy", "kinetic " + with_unit(r.energy.kinetic, "J") + " (at most " +
                               with_unit(result.peak_kinetic_energy, "J") + "), elastic " +
                               with_unit(r.energy.elastic, "J") + ", potential " + with_unit(r.energy.potential, "J") +
                               ", dissipated " + with_unit(r.energy.dissipated, "J"));
    text += line(
        "penetration",
        short_number(1e3 * r.max_penetration) + " mm" +
            (result.mean_edge > 0 ? " (" + percent(r.max_penetration / result.mean_edge) + " of the mean edge)" : "") +
            ", into the contact shell " + short_number(1e3 * r.max_gap_violation) + " mm");
    text += line("elements", "smallest volume ratio " + short_number(r.worst_volume_ratio) +
                                 (r.worst_volume_body.empty() ? "" : " (" + r.worst_volume_body + ")"));
    text += trust_lines(result);
    text += probe_lines(result);
    text += line("stages", "");
    text += stage_table(result);
    char hash[24];
    std::snprintf(hash, sizeof hash, "0x%016" PRIx64, result.state_hash);
    return text + line("state hash", hash);
}

}  // namespace skerry
