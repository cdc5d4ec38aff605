// Warnings: reasons not to rely on the result of a run. Each warning includes a remedy.
#include <algorithm>

#include "engine/output/number_text.h"
#include "engine/program/run_result.h"
#include "engine/program/start_text.h"

namespace skerry {

namespace {

/// Adds warnings about overlaps at the start. Returns true if these overlaps may have caused errors later in the run.
bool warn_of_start(const RunResult& result, std::vector<std::string>& warnings) {
    const WorldReport& r = result.report;
    constexpr std::size_t most_named = 5;
    std::size_t unresolved = 0;
    for (const StartOverlap& overlap : r.start_overlaps)
        if (!overlap.resolved && unresolved++ < most_named)
            warnings.push_back(
                overlap.message() + " at the start: move the objects apart" +
                (overlap.kind == OverlapKind::crossing ? ", or set settings.start_overlaps to \"resolve\"" : ""));
    if (unresolved > most_named)
        warnings.push_back(grouped(unresolved - most_named) +
                           " more overlaps at the start: see the complete list in the file of --stats");
    const Real into_shell = r.start_gap_violation - r.start_penetration;
    const bool in_shell = into_shell > visible_share * result.mean_edge;
    if (in_shell) warnings.push_back(into_shell_text(into_shell));
    if (unresolved == 0 && r.start_penetration > visible_share * result.mean_edge)
        warnings.push_back("surfaces overlap by " + with_unit(r.start_penetration, "m") +
                           " in the first step: move the bodies apart");
    return unresolved > 0 || in_shell;
}

std::string element_text(const std::string& body, Index element) {
    return "(worst: element " + std::to_string(element) + " of body \"" + body + "\")";
}

void warn_of_elements(const WorldReport& r, const std::string& shorter, std::vector<std::string>& warnings) {
    const std::string worst = element_text(r.worst_volume_body, r.worst_volume_element);
    if (r.inverted > 0)
        warnings.push_back("elements turned inside out: " + grouped(static_cast<std::uint64_t>(r.inverted)) + " " +
                           worst + ": " + shorter + ", or refine the mesh there");
    else if (r.inversions > 0)
        warnings.push_back("elements turned inside out during some steps, " + grouped(r.inversions) +
                           " times in total: " + shorter);
    else if (r.near_inversion > 0)
        warnings.push_back("elements compressed to less than a tenth of their rest volume: " +
                           grouped(static_cast<std::uint64_t>(r.near_inversion)) + " " + worst +
                           ": reduce the load, stiffen the material or refine the mesh there");
    if (r.folded > 0)
        warnings.push_back("folded smoothed elements: " + grouped(static_cast<std::uint64_t>(r.folded)) + " " +
                           element_text(r.folded_body, r.folded_element) +
                           ": set \"element\" of this body to \"linear\", or refine the mesh of the body");
}

void warn_of_balance(const WorldReport& r, const std::string& shorter, std::vector<std::string>& warnings) {
    // Relative error of the energy balance above which a warning is given. With the stable step the error is below
    // 1 %.
    constexpr double small_share = 0.02;
    if (r.energy_error_share > small_share)
        warnings.push_back("the energy balance has an error of " + percent(r.energy_error_share) +
                           ", more than the limit of " + percent(small_share) + ": " + shorter);
    constexpr double rounding = 1e-9;  // relative rounding errors of sums of millions of terms are far below this value
    if (r.momentum_error_share > rounding)
        warnings.push_back("the momentum balance has an error of " + percent(r.momentum_error_share) +
                           ", which is larger than rounding errors: please report this as a bug and attach the scene");
}

void warn_of_self_crossings(const WorldReport& r, const std::string& shorter, std::vector<std::string>& warnings) {
    for (const SelfCrossing& crossing : r.self_crossings)
        warnings.push_back(crossing.message() + ": " +
                           (crossing.self_contact ? shorter
                                                  : "set \"self_contact\" of this body to true (the body must then be "
                                                    "explicit)"));
}

}  // namespace

std::vector<std::string> warnings_of(const RunResult& result) {
    const WorldReport& r = result.report;
    std::vector<std::string> warnings = result.plan_warnings;
    const bool bad_start = warn_of_start(result, warnings);
    for (const std::string& boundary : result.bad_boundaries)
        warnings.push_back(boundary +
                           "; contacts may fail there: repair the mesh (`skerry inspect MESH --repair NEW.msh`)");
    warnings.insert(warnings.end(), result.thin_parts.begin(), result.thin_parts.end());
    warnings.insert(warnings.end(), result.contact_areas.begin(), result.contact_areas.end());
    const auto steps = static_cast<Real>(std::max<std::uint64_t>(r.steps, 1));
    const Real mean_step = result.seconds_simulated / steps;
    const std::string shorter = bad_start
                                    ? "first correct the start as described above"
                                    : "shorten the step (set --step or settings.step_size below the mean step of " +
                                          with_unit(mean_step, "s") + ")";
    if (r.unconverged > 0)
        warnings.push_back(grouped(r.unconverged) + " of " + grouped(r.solved) +
                           " contact regions were solved with an error above the tolerance " +
                           short_text(result.settings.tolerance) + ", the largest error being " +
                           short_text(r.worst_error) + ": increase settings.max_iterations (--max-iterations), now " +
                           std::to_string(result.settings.max_iterations) + ", or the tolerance (--tolerance)");
    warn_of_balance(r, shorter, warnings);
    if (r.crossed > 0)
        warnings.push_back("surfaces passed through each other, at " + grouped(r.crossed) +
                           " nodes or edges: " + shorter);
    warn_of_self_crossings(r, shorter, warnings);
    const bool arose = r.max_penetration > 1.01 * r.start_penetration;
    if (arose && result.mean_edge > 0 && r.max_penetration > visible_share * result.mean_edge)
        warnings.push_back("surfaces overlapped during the run by up to " +
                           percent(r.max_penetration / result.mean_edge) + " of the mean edge length: " + shorter);
    if (result.mean_edge > 0 && r.held_penetration > visible_share * result.mean_edge)
        warnings.push_back(
            (r.held_body.empty() ? "held surfaces are" : "held nodes of body \"" + r.held_body + "\" are") + " up to " +
            with_unit(r.held_penetration, "m") + " deep inside " +
            (r.held_in.empty() ? "another object" : "\"" + r.held_in + "\"") +
            ", and no contact can push them out: correct the place or the motion of one of the two");
    if (r.collider_turn > visible_turn) warnings.push_back(turning_text(r));
    warn_of_elements(r, shorter, warnings);
    return warnings;
}

}  // namespace skerry
