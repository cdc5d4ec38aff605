// Which frames a run has, and how many steps they are likely to take.
#pragma once

#include <optional>

#include "engine/program/commands.h"
#include "skerry/scene.h"

namespace skerry {

struct Course {
    double seconds = 0, frame_step = 0;  // s
    int samples = 1;                     // of the probes in a frame

    long frames() const;
    /// s, from the end of the frame before to that of this one.
    double length_of(long frame) const;
    /// s, what no step of the world as it is exceeds, a sample neither.
    double longest_step(const World& world) const;
    /// About how many steps a run takes: samples are cut into equal steps.
    double steps(const World& world) const;
};

/// What the scene says, unless the command line says something else. Throws SceneError for counts without end.
Course course_of(const Scene& scene, const RunOptions& options);

}  // namespace skerry
