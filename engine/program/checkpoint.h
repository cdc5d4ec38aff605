// Checkpoint files of runs: each holds the world and the progress of the run, so that a killed run can be resumed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/place.h"
#include "skerry/scene.h"

namespace skerry {

/// State of a run that is not part of its world.
struct RunMemory {
    std::filesystem::path scene;           // absolute path
    std::vector<std::string> assignments;  // SceneOverrides::assignments
    double seconds = 0;                    // planned duration of the run [s]
    double frame_step = 0;                 // [s]
    int samples = 1;                       // calls of advance per frame
    long frame = 0;                        // number of the frame being simulated
    int sample = 0;                        // index of the next call of advance within the frame
    double seconds_wall = 0;
    Real peak_kinetic_energy = 0;  // [J]
    Json probes = Json::array();
};

struct Restart {
    World world;
    RunMemory memory;
};

/// Reads a checkpoint. Throws SceneError if the file is not a checkpoint of a run.
Restart read_restart(const std::filesystem::path& file, const LoadSettings& settings);

/// Replaces the world of the scene by that of a checkpoint. Throws SceneError unless both have the same bodies and
/// colliders: equal names, and equal numbers of nodes per body.
void put_in_place(const std::filesystem::path& file, World world, Scene& scene);

/// Writes checkpoints while a run goes on.
class CheckpointWriter {
public:
    /// `every`: simulated time between checkpoints [s]. The first is due at the first multiple of it after `time`.
    /// With an empty file name none is written.
    CheckpointWriter(std::filesystem::path file, double every, double time);
    bool due(double time) const;
    /// Reports a failure to write on standard error; the previous checkpoint then stays in place.
    void write(World& world, const RunMemory& memory);
    int written() const { return written_; }
    int failed() const { return failed_; }
    /// Describes the written file for the user.
    std::string summary() const;

private:
    std::filesystem::path file_;
    double every_;
    double next_;  // time at which the next checkpoint is due [s]
    int written_ = 0, failed_ = 0;
};

}  // namespace skerry
