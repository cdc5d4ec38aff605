// Records of a run that users can read. No step depends on these records.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/world/forces/force_ledger.h"
#include "engine/world/state/held_depth.h"
#include "engine/world/state/step_limits.h"
#include "engine/world/step/balance.h"
#include "jobs/trace.h"
#include "skerry/problem.h"
#include "skerry/report.h"

namespace skerry {

/// Subscription of a user to the contact problems of steps: `take` receives the problem of each step with contacts, if
/// the number of the step is a multiple of `every`. Without a subscriber, the stage that copies the data of the problem
/// is skipped.
struct ProblemWatch {
    std::function<void(const StepProblem&)> take;
    std::uint64_t every = 1;

    bool wants(std::uint64_t step) const { return take && step % every == 0; }
};

struct RunRecord {
    RunCounters counters;
    std::vector<StartOverlap> start_overlaps;  // found by the last settle_start
    std::vector<StartMove> start_moves;
    std::vector<SelfCrossing> self_crossings;  // see WorldReport::self_crossings
    StepLimits limits;
    HeldDepth held;  // largest overlap so far of surfaces whose motion is prescribed
    Balance balance;
    Trace trace;
    bool tracing = false;
    ProblemWatch problem_watch;
    ForceLedger forces;
    std::function<void(const StepReport&)> step_watch;
    std::vector<Contact> contact_view;  // the contacts that World::contacts() returns
    // For each entry of contact_view, its row r in StepScratch::contacts. A contact between sleeping bodies has the
    // entry ~r instead, with its row r in ContactCache::resting.
    Column<Index> contact_rows;
    bool contact_view_is_current = false;
    // True if the balance was last checked after a skipped step (a step in which nothing moves), and nothing has moved
    // since. Further checks are then skipped.
    bool balance_of_rest = false;
};

}  // namespace skerry
