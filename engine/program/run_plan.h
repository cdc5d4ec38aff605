// Plan of a run that is resumed.
#pragma once

#include "engine/program/checkpoint.h"
#include "engine/program/commands.h"
#include "engine/scene/run_plan.h"

namespace skerry {

/// Returns the plan of a run that is resumed at `time` [s]. The lengths of frames and samples stay the same, so that
/// the calls of advance are the same as without the interruption. Throws SceneError if nothing is left to simulate.
RunPlan plan_run(const RunOptions& options, const RunMemory& memory, double time);

/// True if a run with a duration of `planned` seconds would end within this frame, and `run_plan` gives the frame
/// another length.
bool cut_short(const RunPlan& run_plan, long frame, double planned);

}  // namespace skerry
