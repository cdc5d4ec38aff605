#include "engine/program/run_plan.h"

#include "engine/base/complaint.h"

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
    refuse_in(options.restart.string(), "--restart", {}, "a checkpoint at " + short_text(time, 6) + " s",
              "a checkpoint from before the end of the run, which is at " + short_text(plan.seconds, 6) + " s",
              "choose a larger --seconds");
}

}  // namespace skerry
