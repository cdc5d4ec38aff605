// Runs that can be killed: a file that holds the world and how far the run has come, and going on from it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/place.h"
#include "skerry/scene.h"

namespace skerry {

/// What a run remembers beside its world.
struct RunMemory {
    std::filesystem::path scene;           // absolute
    std::vector<std::string> assignments;  // SceneOverrides::assignments
    double seconds = 0;                    // s, after which it was to end
    double frame_step = 0;                 // s
    int samples = 1;                       // calls of advance in a frame
    long frame = 0;                        // that is being simulated
    int sample = 0;                        // the next call in it
    double seconds_wall = 0;
    Real peak_kinetic_energy = 0;  // J
    Json probes = Json::array();
};

struct Restart {
    World world;
    RunMemory memory;
};

/// Throws SceneError for anything that is not a checkpoint of a run.
Restart read_restart(const std::filesystem::path& file, const LoadSettings& settings);

/// Puts the world of a checkpoint in place of that of its scene, which has to have the same bodies and colliders: by
/// name, and bodies by numbers of nodes.
void put_in_place(const std::filesystem::path& file, World world, Scene& scene);

/// Writes checkpoints while a run goes on.
class CheckpointWriter {
public:
    /// `every`: s, simulated; the first at the first multiple of it after `time`. No file: none is written.
    CheckpointWriter(std::filesystem::path file, double every, double time);
    bool due(double time) const;
    /// A checkpoint that cannot be written is told on standard error, and the file before it stays.
    void write(World& world, const RunMemory& memory);
    int written() const { return written_; }
    int failed() const { return failed_; }
    /// A line, when any was written.
    std::string summary() const;

private:
    std::filesystem::path file_;
    double every_;
    double next_;  // s
    int written_ = 0, failed_ = 0;
};

}  // namespace skerry
