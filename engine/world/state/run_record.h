// What a run tells about itself. No step depends on any of it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/world/step/balance.h"
#include "jobs/trace.h"
#include "skerry/problem.h"
#include "skerry/report.h"

namespace skerry {

/// Sums over all steps since the world was made.
struct RunCounters {
    std::uint64_t steps = 0, inline_steps = 0, shortened = 0, retried = 0, limited = 0, inversions = 0;
    std::uint64_t contacts = 0, regions = 0, iterations = 0, unconverged = 0, certified = 0, closed_form = 0;
    std::uint64_t separating = 0, frictionless = 0, in_lanes = 0, frozen = 0, contact_steps = 0, swept = 0;
    std::uint64_t element_steps = 0, element_impulses = 0;
    Index max_contacts = 0, max_regions = 0, largest_region = 0, worst_region = 0;
    Real worst_error = 0, dissipated = 0, max_penetration = 0, max_gap_violation = 0;
};

/// Who wants to see contact problems. Idle, it costs a skipped stage.
struct ProblemWatch {
    std::function<void(const StepProblem&)> take;
    std::uint64_t every = 1;

    bool wants(std::uint64_t step) const { return take && step % every == 0; }
};

struct RunRecord {
    RunCounters counters;
    Balance balance;
    Trace trace;
    bool tracing = false;
    ProblemWatch problem_watch;
    std::vector<Contact> contact_view;  // what contacts() shows
    bool contact_view_is_current = false;
};

}  // namespace skerry
