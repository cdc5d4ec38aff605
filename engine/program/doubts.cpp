// Warnings: reasons not to rely on a run, with remedies.
#include <algorithm>

#include "engine/program/number_text.h"
#include "engine/program/run_result.h"
#include "engine/program/start_text.h"

namespace skerry {

namespace {

/// Adds warnings about the start. Returns true if these explain later errors.
bool doubt_start(const RunResult& result, std::vector<std::string>& doubts) {
    const WorldReport& r = result.report;
    constexpr std::size_t most_named = 5;
    std::size_t left = 0;
    for (const StartOverlap& overlap : r.start_overlaps)
        if (!overlap.resolved && left++ < most_named)
            doubts.push_back(
                overlap.message() + " at the start: move them apart" +
                (overlap.kind == OverlapKind::crossing ? ", or set settings.start_overlaps to \"resolve\"" : ""));
    if (left > most_named) doubts.push_back(grouped(left - most_named) + " more overlaps at the start");
    const Real into_shell = r.start_gap_violation - r.start_penetration;
    const bool in_shell = into_shell > visible_share * result.mean_edge;
    if (in_shell) doubts.push_back(into_shell_text(into_shell));
    if (left == 0 && r.start_penetration > visible_share * result.mean_edge)
        doubts.push_back("surfaces overlap by " + with_unit(r.start_penetration, "m") + " in the first step");
    return left > 0 || in_shell;
}

void doubt_elements(const WorldReport& r, std::vector<std::string>& doubts) {
    if (r.inverted > 0)
        doubts.push_back(std::to_string(r.inverted) + " elements are inverted, the worst in " + r.worst_volume_body +
                         ", element " + std::to_string(r.worst_volume_element));
    else if (r.inversions > 0)
        doubts.push_back(grouped(r.inversions) + " times an element was inverted for some steps");
    else if (r.near_inversion > 0)
        doubts.push_back(std::to_string(r.near_inversion) + " elements are near inversion, the worst in " +
                         r.worst_volume_body + ", element " + std::to_string(r.worst_volume_element));
    if (r.folded > 0)
        doubts.push_back(std::to_string(r.folded) + " smoothed elements are folded, some of them in " + r.folded_body +
                         ", the worst at element " + std::to_string(r.folded_element));
}

}  // namespace

std::vector<std::string> doubts_of(const RunResult& result) {
    const WorldReport& r = result.report;
    std::vector<std::string> doubts;
    const bool bad_start = doubt_start(result, doubts);
    doubts.insert(doubts.end(), result.bad_boundaries.begin(), result.bad_boundaries.end());
    const Real longest = std::min(r.stable_step, result.settings.step_size.value_or(r.stable_step));
    const std::string shorter =
        bad_start ? "begin as said above"
                  : "shorten the step (settings.step_size or --step below " + with_unit(longest, "s") + ")";
    constexpr double small_share = 0.02;  // of the energy; at the stable step this error stays below 1 %
    if (r.unconverged > 0)
        doubts.push_back(grouped(r.unconverged) + " of " + grouped(r.solved) +
                         " contact regions ended above the tolerance, the worst at " + short_number(r.worst_error) +
                         ": raise settings.max_iterations (--max-iterations), now " +
                         std::to_string(result.settings.max_iterations));
    if (r.energy_error_share > small_share)
        doubts.push_back("energy does not add up by " + percent(r.energy_error_share) + ": " + shorter);
    constexpr double rounding = 1e-9;  // sums of millions of terms stay far below this
    if (r.momentum_error_share > rounding)
        doubts.push_back("momentum does not add up by " + percent(r.momentum_error_share));
    if (r.crossed > 0) doubts.push_back(grouped(r.crossed) + " features went through each other: " + shorter);
    const bool arose = r.max_penetration > 1.01 * r.start_penetration;
    if (arose && result.mean_edge > 0 && r.max_penetration > visible_share * result.mean_edge)
        doubts.push_back("surfaces came to overlap by " + percent(r.max_penetration / result.mean_edge) +
                         " of the mean edge: " + shorter);
    if (r.collider_turn > visible_turn) doubts.push_back(turning_text(r));
    doubt_elements(r, doubts);
    return doubts;
}

}  // namespace skerry
