// Adds a committed step to the counters of the run.
#include <algorithm>

#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Counts how many regions used each shortcut of the solver. The loop has no branches, because a processor cannot
/// predict which shortcut a region used. All threads wait for this loop.
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
    counters.closed_form += closed_form;
    counters.certified += certified;
    counters.separating += separating;
    counters.frictionless += frictionless;
    counters.in_lanes += in_lanes;
    counters.swept += swept;
    counters.contact_steps += contact_steps;
    counters.iteration_sum += iterations;
    counters.unconverged += unconverged;
    counters.largest_region = largest;
}

}  // namespace

void count_step(const StepScratch& scratch, RunCounters& counters) {
    const RegionTable& regions = scratch.regions;
    const StepFindings& findings = scratch.findings;
    const auto contact_count = static_cast<Index>(scratch.contacts.size());
    const auto region_count = static_cast<Index>(regions.size());
    if (counters.steps++ == 0) {
        counters.start_penetration = findings.measures.max_penetration;
        counters.start_gap_violation = findings.measures.max_gap_violation;
    }
    counters.contact_sum += static_cast<std::uint64_t>(contact_count);
    counters.solved += static_cast<std::uint64_t>(region_count);
    counters.max_contacts = std::max(counters.max_contacts, contact_count);
    counters.max_regions = std::max(counters.max_regions, region_count);
    count_shortcuts(regions, counters);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        if (!(regions.error[r] > counters.worst_error)) continue;
        counters.worst_error = regions.error[r];
        counters.worst_region = regions.contacts.offset[r + 1] - regions.contacts.offset[r];
    }
    counters.large_strain_steps += findings.strained.newton.solved;
    counters.newton_steps += findings.strained.newton.steps;
    counters.tangent_factors += findings.strained.newton.factors;
    counters.inline_steps += scratch.ran_inline;
    counters.resting_steps += scratch.left_out;
    counters.unstrained += static_cast<std::uint64_t>(findings.unstrained);
    counters.dissipated += findings.measures.dissipated + findings.damped + findings.strained.damped +
                           findings.relaxed + findings.viscous + findings.plastic + findings.rest.energy +
                           findings.springs.dissipated + findings.cables.dissipated;
    counters.plastic_work += findings.plastic;
    counters.max_penetration = std::max(counters.max_penetration, findings.measures.max_penetration);
    counters.max_gap_violation = std::max(counters.max_gap_violation, findings.measures.max_gap_violation);
}

}  // namespace skerry
