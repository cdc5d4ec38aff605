// Counts the contacts and regions of a step for the counters of the run.
#include <algorithm>

#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Counts how many regions used each shortcut of the solver. The loop has no branches, because a processor cannot
/// predict which shortcut a region used. It must be fast, because it runs between two steps while all threads wait.
void count_shortcuts(const RegionTable& regions, RunCounters& counters) {
    std::uint64_t closed_form = 0, certified = 0, separating = 0, frictionless = 0, in_lanes = 0, swept = 0;
    std::uint64_t iterations = 0, unconverged = 0, contact_steps = 0;
    Index largest = counters.largest_region;
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const unsigned shortcut = regions.shortcut[r];
        const Index size = regions.contacts.offset[r + 1] - regions.contacts.offset[r];
        const auto sweeps = static_cast<std::uint64_t>(regions.iterations[r]);
        const bool was_swept = (shortcut & (shortcut_closed_form | shortcut_certified | shortcut_separating)) == 0;
        closed_form += (shortcut & shortcut_closed_form) != 0;
        certified += (shortcut & shortcut_certified) != 0;
        separating += (shortcut & shortcut_separating) != 0;
        frictionless += (shortcut & shortcut_frictionless) != 0;
        in_lanes += (shortcut & shortcut_in_lanes) != 0;
        swept += was_swept;
        contact_steps += static_cast<std::uint64_t>(was_swept) * static_cast<std::uint64_t>(size) * sweeps;
        iterations += sweeps;
        unconverged += regions.status[r] == RegionStatus::iteration_limit;
        largest = std::max(largest, size);
    }
    counters.closed_form = closed_form;
    counters.certified = certified;
    counters.separating = separating;
    counters.frictionless = frictionless;
    counters.in_lanes = in_lanes;
    counters.swept = swept;
    counters.contact_steps = contact_steps;
    counters.iteration_sum = iterations;
    counters.unconverged = unconverged;
    counters.largest_region = largest;
}

/// Replaces the worst error by `error` if `error` is larger, or if it is equal and its region has more contacts.
/// `region`: number of contacts of the region with this error.
void note_error(Real error, Index region, RunCounters& counters) {
    if (error < counters.worst_error || (error == counters.worst_error && region <= counters.worst_region)) return;
    counters.worst_error = error;
    counters.worst_region = region;
}

}  // namespace

RunCounters count_step(const ContactTable& contacts, const RegionTable& regions, const ContactMeasures& measures,
                       const NewtonCounts& newton, Index unstrained) {
    RunCounters counters;
    counters.steps = 1;
    counters.contact_sum = contacts.size();
    counters.solved = regions.size();
    count_shortcuts(regions, counters);
    for (std::size_t r = 0; r < regions.size(); ++r)
        if (regions.error[r] > 0)
            note_error(regions.error[r], regions.contacts.offset[r + 1] - regions.contacts.offset[r], counters);
    counters.large_strain_steps = newton.solved;
    counters.newton_steps = newton.steps;
    counters.tangent_factors = newton.factors;
    counters.unstrained = static_cast<std::uint64_t>(unstrained);
    counters.max_penetration = measures.max_penetration;
    counters.max_gap_violation = measures.max_gap_violation;
    return counters;
}

void add_counters(const RunCounters& from, RunCounters& into) {
    constexpr std::uint64_t RunCounters::*sums[] = {
        &RunCounters::steps,        &RunCounters::inline_steps,    &RunCounters::resting_steps,
        &RunCounters::unstrained,   &RunCounters::contact_sum,     &RunCounters::iteration_sum,
        &RunCounters::solved,       &RunCounters::unconverged,     &RunCounters::certified,
        &RunCounters::closed_form,  &RunCounters::separating,      &RunCounters::frictionless,
        &RunCounters::in_lanes,     &RunCounters::swept,           &RunCounters::contact_steps,
        &RunCounters::newton_steps, &RunCounters::tangent_factors, &RunCounters::large_strain_steps};
    for (const auto sum : sums) into.*sum += from.*sum;
    into.max_contacts = std::max(into.max_contacts, from.max_contacts);
    into.max_regions = std::max(into.max_regions, from.max_regions);
    into.largest_region = std::max(into.largest_region, from.largest_region);
    note_error(from.worst_error, from.worst_region, into);
    into.max_penetration = std::max(into.max_penetration, from.max_penetration);
    into.max_gap_violation = std::max(into.max_gap_violation, from.max_gap_violation);
}

void count_committed_step(const RunCounters& step, RunCounters& run) {
    if (run.steps == 0) {
        run.start_penetration = step.max_penetration;
        run.start_gap_violation = step.max_gap_violation;
    }
    run.max_contacts = std::max(run.max_contacts, static_cast<Index>(step.contact_sum));
    run.max_regions = std::max(run.max_regions, static_cast<Index>(step.solved));
    add_counters(step, run);
}

Real dissipated_in(const StepFindings& findings) {
    return findings.measures.dissipated + findings.damped + findings.strained.damped + findings.relaxed +
           findings.viscous + findings.plastic + findings.rest.energy + findings.springs.dissipated +
           findings.cables.dissipated;
}

}  // namespace skerry
