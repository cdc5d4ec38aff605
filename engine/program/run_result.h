// What a run was and what came of it, and its two tellings: for scripts and for people.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/program/commands.h"
#include "engine/program/probe_recorder.h"
#include "skerry/scene.h"

namespace skerry {

struct RunResult {
    std::string scene;
    std::string scene_file;
    std::string status = "ok";  // else what went wrong
    int stopped_by = 0;         // the signal that did; 0: none
    Settings settings;
    int threads = 0;  // as used
    double seconds_simulated = 0;
    double seconds_wall = 0;    // in the steps themselves
    double seconds_load = 0;    // reading and building
    double seconds_output = 0;  // writing frames
    int frames = 0;
    std::optional<double> restarted_at;           // s, where a checkpoint was taken up
    int checkpoints = 0, checkpoints_failed = 0;  // written, and not, in this part of the run
    Real peak_kinetic_energy = 0;                 // J, of all frames
    Real mean_edge = 0;                           // m, mean over the bodies' surfaces
    WorldReport report;
    std::uint64_t state_hash = 0;
    std::vector<ProbeRecord> probes;
    std::vector<std::pair<std::string, std::string>> outputs_failed;  // option, and what stood in the way
    std::vector<std::string> bad_boundaries;                          // of the bodies' meshes, a sentence each
    std::string written;                                              // a line for each output and checkpoint
};

/// Carries a run out, with its outputs. Throws SceneError for a scene or options that it does not understand.
RunResult simulate(const RunOptions& options);

/// Why not to rely on the run, a sentence each; empty when all estimates are small.
std::vector<std::string> doubts_of(const RunResult& result);
/// The document of --stats; the names of its keys are part of the interface.
Json statistics_of(const RunResult& result);
/// The table at the end of a run.
std::string summary_of(const RunResult& result);

}  // namespace skerry
