// Checkpoint files of runs. A checkpoint holds the world and the progress of a run, so that a killed run can be
// resumed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/place.h"
#include "skerry/scene.h"

namespace skerry {

/// Progress of a run that a checkpoint stores in addition to the world.
struct RunMemory {
    std::filesystem::path scene;           // absolute path of the scene file
    std::vector<std::string> assignments;  // assignments PLACE=VALUE that change the scene
    double seconds = 0;                    // planned duration of the run [s]
    double frame_step = 0;                 // time between two frames [s]
    int samples = 1;                       // largest number of calls of World::advance per frame
    double probe_step = 0;                 // time between two samples of the probes; 0: no probes [s]
    long frame = 0;                        // number of the frame being simulated
    int sample = 0;                        // index of the next call of advance within the frame
    double seconds_wall = 0;
    Real peak_kinetic_energy = 0;  // largest value at the end of a frame so far [J]
    Json probes = Json::array();
};

Json to_json(const RunMemory& memory);
/// Parses the text of a JSON document from to_json(). `source`: file or rank that the text comes from, for messages.
/// Throws SceneError if the text is empty or damaged.
RunMemory memory_of(const std::filesystem::path& source, const std::string& text);

struct Restart {
    World world;
    RunMemory memory;
};

/// Reads a checkpoint. Throws SceneError if the file is not a checkpoint of a run.
Restart read_restart(const std::filesystem::path& file, const LoadSettings& settings);

/// Replaces the world of the scene by the world of a checkpoint, to which the probes of the scene then refer. Throws
/// SceneError unless both worlds have the same bodies and colliders, with equal names and with equal numbers of nodes
/// per body. `file` is named in messages.
void put_in_place(const std::filesystem::path& file, World world, Scene& scene);

/// Writes checkpoints during a run.
class CheckpointWriter {
public:
    /// `every` is the simulated time between checkpoints [s]. The first checkpoint is due at the first multiple of
    /// `every` after `time`. If the file name is empty, no checkpoints are written.
    CheckpointWriter(std::filesystem::path file, double every, double time);
    bool wanted() const { return !file_.empty(); }
    bool due(double time) const;
    /// Writes a checkpoint of the world at `time`. If this fails, reports the error on standard error and leaves the
    /// previous checkpoint in place. `world`: null on a rank (MPI process) that writes no files; the call then only
    /// schedules the next checkpoint.
    void write(World* world, double time, const RunMemory& memory);
    int written() const { return written_; }
    int failed() const { return failed_; }
    /// Error of the last attempt to write a checkpoint; empty if it succeeded. After an error, the file holds the state
    /// of an earlier checkpoint, if it exists at all.
    const std::string& failure() const { return failure_; }
    /// Returns a description of the checkpoint file for the user.
    std::string summary() const;
    /// Returns the line to print when the MPI launcher ends the job. It names the last checkpoint, if there is one.
    std::string last_words() const;

private:
    std::filesystem::path file_;
    double every_;
    double next_;      // time at which the next checkpoint is due [s]
    double last_ = 0;  // time of the last checkpoint that was written [s]
    int written_ = 0, failed_ = 0;
    std::string failure_;
};

}  // namespace skerry
