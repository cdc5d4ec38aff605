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
/// length in the resumed run. The checkpoint may then lie within the frame, the rest of which must be divided anew into
/// calls of World::advance. `run_plan`: plan of the resumed run.
bool cut_short(const RunPlan& run_plan, long frame, double planned);

}  // namespace skerry
