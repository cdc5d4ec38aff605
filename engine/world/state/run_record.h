// Records of a run for users. No step depends on these records.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/world/forces/force_ledger.h"
#include "engine/world/state/step_limits.h"
#include "engine/world/step/balance.h"
#include "jobs/trace.h"
#include "skerry/problem.h"
#include "skerry/report.h"

namespace skerry {

/// Subscription to contact problems. Without a subscriber it costs only a skipped stage.
struct ProblemWatch {
    std::function<void(const StepProblem&)> take;
    std::uint64_t every = 1;

    bool wants(std::uint64_t step) const { return take && step % every == 0; }
};

struct RunRecord {
    RunCounters counters;
    std::vector<StartOverlap> start_overlaps;  // found by the last check for overlaps
    std::vector<StartMove> start_moves;
    StepLimits limits;
    Balance balance;
    Trace trace;
    bool tracing = false;
    ProblemWatch problem_watch;
    ForceLedger forces;
    std::function<void(const StepReport&)> step_watch;
    std::vector<Contact> contact_view;  // the result of contacts()
    Column<Index> contact_rows;  // by entry of contact_view: row of the contact; ~row for a contact of sleeping bodies
    bool contact_view_is_current = false;
    bool balance_of_rest = false;  // nothing has moved since the last check of the balance
};

}  // namespace skerry
