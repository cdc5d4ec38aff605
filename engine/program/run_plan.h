// Plan of a run that is resumed.
#pragma once

#include "engine/program/checkpoint.h"
#include "engine/program/commands.h"
#include "engine/scene/run_plan.h"

namespace skerry {

/// Returns the plan of a run that is resumed at `time` [s]. The times between frames and between samples are those in
/// `memory`, so that the calls of advance are the same as without the interruption. Throws SceneError if nothing is
/// left to simulate, or if there are too many frames.
RunPlan plan_run(const RunOptions& options, const RunMemory& memory, double time);

/// True if the interrupted run was to end within this frame, at the time `planned` [s], and the frame has another
/// length in `run_plan`, the plan of the resumed run. The checkpoint may then be from a time within the frame, and the
/// rest of the frame must be divided anew into calls of World::advance.
bool cut_short(const RunPlan& run_plan, long frame, double planned);

}  // namespace skerry
