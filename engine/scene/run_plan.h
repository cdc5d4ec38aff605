// Plan of a run: its division into frames, the division of each frame into calls of World::advance, and an estimate of
// the number of steps.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "skerry/scene.h"

namespace skerry {

struct RunPlan {
    // Tolerance for rounding when a run is divided into frames, as a fraction of `frame_step`: 0.1 s must give six
    // frames of 1/60 s, not seven.
    static constexpr double slack = 1e-9;

    double seconds = 0, frame_step = 0;  // duration of the run, and time between two frames [s]
    int samples = 1;                     // largest number of calls of World::advance per frame
    double probe_step = 0;               // time between two samples of the probes; 0: there are no probes [s]

    long frames() const;
    /// True if there are no probes, or if the time between frames is a multiple of probe_step. In the second case each
    /// call of advance in a frame of full length ends with a sample of the probes.
    bool even() const;
    /// Returns the times at which the calls of advance in a frame end [s]: multiples of probe_step, then the end of the
    /// frame. Returns an empty list if the frame is divided into `samples` calls of equal length.
    std::vector<double> ends_in(long frame) const;
    /// Returns the length of a frame: the simulated time since the previous frame [s]. The last frame may be shorter
    /// than the others.
    double length_of(long frame) const;
    /// Longest simulated time of a call of advance [s].
    double longest_call() const;
    /// Returns an upper bound of the step length in the present state of the world [s]: the shortest of the stable
    /// step, the step size of the settings and the longest call of advance.
    double longest_step(const World& world) const;
    /// Throws SceneError if there are more than 1e9 frames. `file`: scene file, for the message.
    void require_countable(const std::filesystem::path& file) const;
    /// Estimates the number of remaining steps. Each call of advance is divided into equal steps, none longer than
    /// longest_step().
    double steps(const World& world) const;
};

/// Returns the plan of a new run of a scene. `seconds` and `frames_per_second` override the values of the scene. Throws
/// SceneError if there are more than 1e9 frames, more than 1e9 samples per frame, or more than 1e9 steps of
/// Settings::step_size between two of them. `file`: scene file, for messages.
RunPlan plan_run(const Scene& scene, const std::filesystem::path& file, std::optional<Real> seconds,
                 std::optional<Real> frames_per_second = {});

}  // namespace skerry
