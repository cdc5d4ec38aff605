// What a committed step adds to the sums of the run.
#include <algorithm>

#include "engine/world/step/step.h"

namespace skerry {

namespace {

void count_shortcuts(const RegionTable& regions, std::size_t r, RunCounters& counters) {
    const RegionShortcut shortcut = regions.shortcut[r];
    counters.closed_form += (shortcut & shortcut_closed_form) != 0;
    counters.certified += (shortcut & shortcut_certified) != 0;
    counters.separating += (shortcut & shortcut_separating) != 0;
    counters.frictionless += (shortcut & shortcut_frictionless) != 0;
    counters.in_lanes += (shortcut & shortcut_in_lanes) != 0;
    counters.frozen += static_cast<std::uint64_t>(regions.frozen[r]);
    if ((shortcut & (shortcut_closed_form | shortcut_certified | shortcut_separating)) != 0) return;
    ++counters.swept;
    const Index size = regions.contacts.offset[r + 1] - regions.contacts.offset[r];
    counters.contact_steps += static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(regions.iterations[r]);
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
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const Index size = regions.contacts.offset[r + 1] - regions.contacts.offset[r];
        counters.largest_region = std::max(counters.largest_region, size);
        counters.iteration_sum += static_cast<std::uint64_t>(regions.iterations[r]);
        count_shortcuts(regions, r, counters);
        counters.unconverged += regions.status[r] == RegionStatus::iteration_limit;
        if (!(regions.error[r] > counters.worst_error)) continue;
        counters.worst_error = regions.error[r];
        counters.worst_region = size;
    }
    counters.large_strain_steps += findings.strained.newton.solved;
    counters.newton_steps += findings.strained.newton.steps;
    counters.tangent_factors += findings.strained.newton.factors;
    counters.inline_steps += scratch.ran_inline;
    counters.resting_steps += scratch.left_out;
    counters.unstrained += static_cast<std::uint64_t>(findings.unstrained);
    counters.dissipated += findings.measures.dissipated + findings.damped + findings.strained.damped +
                           findings.relaxed + findings.viscous + findings.rest.energy;
    counters.max_penetration = std::max(counters.max_penetration, findings.measures.max_penetration);
    counters.max_gap_violation = std::max(counters.max_gap_violation, findings.measures.max_gap_violation);
}

}  // namespace skerry
