// What a run tells about itself. No step depends on any of it.
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

/// Who wants to see contact problems. Idle, it costs a skipped stage.
struct ProblemWatch {
    std::function<void(const StepProblem&)> take;
    std::uint64_t every = 1;

    bool wants(std::uint64_t step) const { return take && step % every == 0; }
};

struct RunRecord {
    RunCounters counters;
    std::vector<StartOverlap> start_overlaps;  // of the last look
    std::vector<StartMove> start_moves;
    StepLimits limits;
    Balance balance;
    Trace trace;
    bool tracing = false;
    ProblemWatch problem_watch;
    ForceLedger forces;
    std::function<void(const StepReport&)> step_watch;
    std::vector<Contact> contact_view;  // what contacts() shows
    Column<Index> contact_rows;         // of merge_contacts: which contact each of them is
    bool contact_view_is_current = false;
    bool balance_of_rest = false;  // the last look at the balance was since nothing moves
};

}  // namespace skerry
