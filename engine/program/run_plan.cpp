#include "engine/program/run_plan.h"

#include <cstdio>

#include "skerry/error.h"

namespace skerry {

bool cut_short(const RunPlan& plan, long frame, double planned) {
    RunPlan earlier = plan;
    earlier.seconds = planned;
    const double before = earlier.length_of(frame);
    const bool within = before > RunPlan::slack * plan.frame_step && before < (1 - RunPlan::slack) * plan.frame_step;
    return within && before != plan.length_of(frame);
}

RunPlan plan_run(const RunOptions& options, const RunMemory& memory, double time) {
    const RunPlan plan{options.seconds.value_or(memory.seconds), memory.frame_step, memory.samples, memory.probe_step};
    plan.require_countable(options.scene);
    if (plan.seconds > time + RunPlan::slack * plan.frame_step) return plan;
    char found[128], expected[128];
    std::snprintf(found, sizeof found, "a checkpoint at %g s", time);
    std::snprintf(expected, sizeof expected, "a checkpoint from before the end of the run, which is at %g s",
                  plan.seconds);
    Complaint{.file = options.restart.string(),
              .object = "--restart",
              .field = {},
              .found = found,
              .expected = expected,
              .hint = "choose a larger --seconds"}
        .raise();
}

}  // namespace skerry
