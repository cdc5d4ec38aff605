// How a run is cut into frames of output, frames into calls of advance, and how many steps they are likely to take.
#pragma once

#include "engine/program/checkpoint.h"
#include "engine/program/commands.h"

namespace skerry {

struct Course {
    static constexpr double slack = 1e-9;  // of a frame: 0.1 s are six frames of 1/60 s, not seven

    double seconds = 0, frame_step = 0;  // s
    int samples = 1;                     // of the probes in a frame

    long frames() const;
    /// s, from the end of the frame before to that of this one: the last may be shorter.
    double length_of(long frame) const;
    /// s, what no step of the world as it is exceeds, a sample neither.
    double longest_step(const World& world) const;
    /// About how many steps are left: samples are cut into equal steps.
    double steps(const World& world) const;
};

/// What the scene says, unless the command line says something else. Throws SceneError for counts without end.
Course course_of(const Scene& scene, const RunOptions& options);
/// Of a run that is taken up at `time`: frames and samples are those that it had, since calls of advance have to be the
/// same. Throws SceneError when nothing of it is left.
Course course_of(const RunOptions& options, const RunMemory& memory, double time);

/// Whether a run that was to end after `planned` seconds ends within a frame, which this one makes longer.
bool cut_short(const Course& course, long frame, double planned);

}  // namespace skerry
