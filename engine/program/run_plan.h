// Division of a run into output frames and of frames into calls of advance; estimate of the number of steps.
#pragma once

#include "engine/program/checkpoint.h"
#include "engine/program/commands.h"

namespace skerry {

struct RunPlan {
    static constexpr double slack = 1e-9;  // share of a frame: 0.1 s are six frames of 1/60 s, not seven

    double seconds = 0, frame_step = 0;  // [s]
    int samples = 1;                     // probe samples per frame, each one call of advance

    long frames() const;
    /// Time from the end of the previous frame to the end of this one; the last frame may be shorter [s].
    double length_of(long frame) const;
    /// Upper bound of the step size in the current state of the world, also bounded by the length of a sample [s].
    double longest_step(const World& world) const;
    /// Estimate of the number of remaining steps. Each sample is divided into equal steps.
    double steps(const World& world) const;
};

/// Plan of a new run: options of the command line override values of the scene. Throws SceneError for more than 1e9
/// frames or samples per frame.
RunPlan plan_run(const Scene& scene, const RunOptions& options);
/// Plan of a run that is resumed at `time`. It keeps the frames and samples of the first part, because the calls of
/// advance have to be the same. Throws SceneError if nothing is left to simulate.
RunPlan plan_run(const RunOptions& options, const RunMemory& memory, double time);

/// True if a run planned for `planned` seconds would have ended within this frame, and `plan` makes the frame longer
/// or shorter.
bool cut_short(const RunPlan& run_plan, long frame, double planned);

}  // namespace skerry
