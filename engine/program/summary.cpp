// Summary that is printed at the end of a run, for people who do not know the methods of the engine.
#include <algorithm>
#include <cmath>

#include "engine/output/number_text.h"
#include "engine/program/dynamics_text.h"
#include "engine/program/run_result.h"
#include "engine/program/start_text.h"

namespace skerry {

namespace {

std::string count_of(std::size_t count, const std::string& noun, const std::string& nouns) {
    return grouped(count) + " " + (count == 1 ? noun : nouns);
}

/// Returns the numbers of bodies, colliders, tetrahedra and nodes, for example "11 deformable (2 of them implicit), 1
/// rigid, 1 collider, 1,536 tetrahedra, 560 nodes".
std::string bodies_text(const RunResult& result) {
    const WorldReport& r = result.report;
    const std::size_t deformable = r.bodies - result.rigid_bodies;
    std::string text;
    const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (deformable > 0 || r.bodies == 0) add(grouped(deformable) + " deformable");
    if (result.implicit_bodies > 0) text += " (" + grouped(result.implicit_bodies) + " of them implicit)";
    if (result.rigid_bodies > 0) add(grouped(result.rigid_bodies) + " rigid");
    add(count_of(r.colliders, "collider", "colliders"));
    add(count_of(r.elements, "tetrahedron", "tetrahedra"));
    add(count_of(r.nodes, "node", "nodes"));
    if (r.asleep > 0) text += "; " + count_of(r.asleep, "body", "bodies") + " at rest at the end";
    return text;
}

std::string time_text(const RunResult& result) {
    constexpr double least = 1e-3;  // a shorter computing time for output is not mentioned [s]
    return with_unit(result.seconds_wall, "s") + " for the steps on " +
           count_of(static_cast<std::size_t>(result.threads), "thread", "threads") +
           (result.ranks.count > 1 ? " of each rank" : "") +
           (result.seconds_output < least ? "" : ", " + with_unit(result.seconds_output, "s") + " for output");
}

std::string start_lines(const RunResult& result) {
    return summary_line("set-up", with_unit(result.seconds_load, "s") + " to read the scene and its meshes, " +
                                      with_unit(result.seconds_setup, "s") +
                                      " to add the bodies, find overlaps and choose the step length") +
           (result.report.start_moves.empty() ? "" : summary_line("start", moves_text(result.report)));
}

std::string penetration_text(const RunResult& result) {
    const WorldReport& r = result.report;
    const auto deep = [&](Real depth) {
        return "at most " + with_unit(depth, "m") +
               (result.mean_edge > 0 ? " (" + percent(depth / result.mean_edge) + " of the mean edge length)" : "");
    };
    std::string text;
    if (r.max_penetration > 0) text = deep(r.max_penetration);
    if (r.held_penetration > 0) text += (text.empty() ? "" : "; ") + ("held surfaces " + deep(r.held_penetration));
    if (text.empty()) text = "none in any contact";
    if (!r.self_crossings.empty()) {
        const bool crosses_at_end =
            std::ranges::any_of(r.self_crossings, [](const auto& crossing) { return crossing.last_places > 0; });
        return text + "; a surface " + (crosses_at_end ? "crosses" : "crossed") +
               " itself, to a depth that is not measured (see the warning)";
    }
    return text + (r.crossed > 0 ? "" : "; no surface crosses itself");
}

std::string contacts_text(const RunResult& result) {
    const WorldReport& r = result.report;
    if (r.max_contacts > 0 || r.bodies + r.colliders < 2)
        return short_text(r.mean_contacts, 4) + " in a step on average, at most " +
               grouped(static_cast<std::uint64_t>(r.max_contacts));
    return "no contact in the whole run" +
           (result.nearest.empty() ? "" : ": the shortest distance at the end is " + result.nearest);
}

std::string balance_text(const WorldReport& r) {
    constexpr double rounding = 1e-9;  // relative errors of the momentum below this value are rounding errors
    const std::string untrusted = r.distrust().empty() ? "" : "not to be trusted: ";
    return untrusted + "energy error " + percent(r.energy_error_share) + ", momentum error " +
           (std::isnan(r.momentum_error)        ? "not available, because a pinned body is damped or implicit"
            : r.momentum_error_share < rounding ? "within rounding"
                                                : percent(r.momentum_error_share));
}

/// Returns the largest estimated errors of all bodies. If there are several bodies, it names the body with each error,
/// for example "mesh about 3 % of the motion (body 'arm') and about 12 % of the largest stress (body 'arm'), steps
/// about 0.1 % of the motion (body 'ball')".
std::string errors_text(const std::vector<ErrorEstimate>& errors) {
    constexpr Real least = 1e-4;  // smaller estimates are mostly rounding errors
    std::string text;
    const auto add = [&](const char* between, const std::string& before, const std::string& after, auto&& error_of) {
        const ErrorEstimate* worst = nullptr;
        Real largest = 0;
        for (const ErrorEstimate& estimate : errors)
            if (const Real error = std::abs(error_of(estimate)); error > largest) {
                worst = &estimate;
                largest = error;
            }
        if (!worst) return;
        const std::string size = largest >= 1      ? "100 % or more"
                                 : largest < least ? "less than " + percent(least)
                                                   : "about " + percent(largest);
        text += (text.empty() ? "" : between) + before + size + " of " + after +
                (errors.size() > 1 ? " (body '" + worst->name + "')" : "");
    };
    // `deflection` is an error relative to the displacements by deformation. `deformation` is the share of these
    // displacements in the motion. Their product is the error relative to the motion.
    add("", "mesh ", "the motion",
        [](const ErrorEstimate& estimate) { return estimate.deflection * estimate.deformation; });
    const bool is_rigid_motion = std::ranges::any_of(errors, [](const ErrorEstimate& estimate) {
        return estimate.deformation < 0.9 && !std::isnan(estimate.deflection);
    });
    if (is_rigid_motion)
        add(", ", text.empty() ? "mesh " : "", "the deformation",
            [](const ErrorEstimate& estimate) { return estimate.deflection; });
    add(" and ", text.empty() ? "mesh " : "", "the largest stress",
        [](const ErrorEstimate& estimate) { return estimate.stress; });
    add(", ", "steps ", "the motion", [](const ErrorEstimate& estimate) { return estimate.step; });
    add(", ", "contact solver ", "the forces", [](const ErrorEstimate& estimate) { return estimate.contact; });
    return text;
}

std::string probe_lines(const RunResult& result) {
    std::string text;
    for (const ProbeRecord& probe : result.probes)
        text +=
            summary_line(text.empty() ? "probes" : "",
                         probe.name + ": sticks " + with_unit(probe.stick_time, "s") + ", slides " +
                             with_unit(probe.slide_time, "s") + " (" + with_unit(probe.slide_alone_time, "s") +
                             " of this while no other probe slides), no contact " + with_unit(probe.open_time, "s") +
                             ", " + count_of(static_cast<std::size_t>(probe.changes), "change", "changes") +
                             " between sticking and sliding; slip distance " + with_unit(probe.slip_distance, "m") +
                             ", largest slip speed " + with_unit(probe.max_slip, "m/s") +
                             "; largest von Mises stress " + with_unit(probe.max_von_mises, "Pa"));
    return text;
}

std::string tie_lines(const RunResult& result) {
    std::string text;
    for (const BrokenTie& tie : result.broken_ties) {
        const std::string last = with_unit(tie.last_time, "s");
        const bool at_once = tie.first_time == tie.last_time;
        text += summary_line(text.empty() ? "ties" : "",
                             tie.name + ": " + grouped(tie.broken) + " of " + count_of(tie.nodes, "node", "nodes") +
                                 " broke off" +
                                 (at_once ? " at " + last : " from " + with_unit(tie.first_time, "s") + " to " + last) +
                                 "; largest force of the tie " + with_unit(tie.largest_force, "N"));
    }
    return text;
}

std::string warning_lines(const RunResult& result) {
    std::string text;
    for (const std::string& warning : warnings_of(result)) text += summary_line("WARNING", warning);
    if (!text.empty()) return text;
    return summary_line("warnings", result.status == "ok" ? "none" : "none for the simulated part of the run");
}

/// Line about the processes that shared the run. Empty if there was only one.
std::string ranks_line(const RanksReport& ranks) {
    if (ranks.count == 1) return {};
    return summary_line("ranks",
                        count_of(static_cast<std::size_t>(ranks.count), "rank", "ranks") + " on " +
                            count_of(static_cast<std::size_t>(ranks.hosts), "host", "hosts") + "; " +
                            short_text(ranks.messages) + " messages with " + short_text(ranks.bytes) + " bytes and " +
                            short_text(ranks.reductions) + " reductions in a step on average; waiting takes " +
                            percent(ranks.waiting) + " of the time, and the busiest rank computes " +
                            short_text(ranks.imbalance) + " times as long as the mean; memory of rank 0 " +
                            with_unit(ranks.peak_memory.front(), "B") + ", of the others at most " +
                            with_unit(*std::max_element(ranks.peak_memory.begin() + 1, ranks.peak_memory.end()), "B"));
}

/// Lines with statistics of the steps. Empty if no step was made.
std::string step_lines(const RunResult& result) {
    const WorldReport& r = result.report;
    if (r.steps == 0) return {};
    const std::string errors = errors_text(result.errors);
    return summary_line("steps", grouped(r.steps) + " of " +
                                     with_unit(result.seconds_simulated / static_cast<double>(r.steps), "s") +
                                     " on average") +
           summary_line("time", time_text(result)) + ranks_line(result.ranks) +
           summary_line("contacts", contacts_text(result)) + summary_line("penetration", penetration_text(result)) +
           summary_line("balance", balance_text(r)) + (errors.empty() ? "" : summary_line("errors", errors));
}

std::string file_lines(const RunResult& result) {
    std::string text;
    for (const std::string& file : result.written) text += summary_line("wrote", file);
    for (const auto& [option, error] : result.outputs_failed)
        text += summary_line("NOT WRITTEN", option + ": " + error);
    return text.empty() ? summary_line("wrote", "no files; add --page FILE.html to play the run in a browser") : text;
}

}  // namespace

std::string summary_of(const RunResult& result) {
    const WorldReport& r = result.report;
    const double simulated = result.seconds_simulated, wall = result.seconds_wall;
    std::string text = result.scene + ": " + short_text(simulated, 4) + " s simulated in " + with_unit(wall, "s");
    if (const double start = result.seconds_load + result.seconds_setup; start > wall)
        text += ", after " + with_unit(start, "s") + " of loading and set-up";
    if (wall > 0) text += ", " + short_text(simulated / wall) + " times real time";
    text += "\n" + summary_line("scene", result.scene_file);
    if (result.status != "ok") text += summary_line(result.distrusted ? "NOT TRUSTED" : "ENDED EARLY", result.status);
    if (result.restarted_at) text += summary_line("restarted", "at " + with_unit(*result.restarted_at, "s"));
    text += summary_line("bodies", bodies_text(result));
    if (const std::string choices = choices_text(r); !choices.empty()) text += summary_line("dynamics", choices);
    return text + start_lines(result) + step_lines(result) + warning_lines(result) + tie_lines(result) +
           probe_lines(result) + file_lines(result);
}

}  // namespace skerry
