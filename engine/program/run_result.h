// Result of a run, and its two presentations: JSON for scripts and text for people.
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
    std::string status = "ok";  // otherwise the error
    int stopped_by = 0;         // number of the signal that stopped the run; 0: none
    Settings settings;
    int threads = 0;  // number actually used
    double seconds_simulated = 0;
    double seconds_wall = 0;    // wall time of the steps alone
    double seconds_load = 0;    // wall time for reading and building the scene
    double seconds_output = 0;  // wall time for writing outputs and checkpoints
    int frames = 0;
    std::optional<double> restarted_at;           // time of the checkpoint from which the run resumed [s]
    int checkpoints = 0, checkpoints_failed = 0;  // written and failed in this part of the run
    Real peak_kinetic_energy = 0;                 // largest value of all frames [J]
    Real mean_edge = 0;                           // mean over the bodies' surfaces [m]
    WorldReport report;
    std::uint64_t state_hash = 0;
    std::vector<ProbeRecord> probes;
    std::vector<std::pair<std::string, std::string>> outputs_failed;  // option and error
    std::vector<std::string> bad_boundaries;                          // one sentence for each invalid mesh boundary
    std::string written;                                              // one line for each output and checkpoint
};

/// Carries out a run with its outputs. Throws SceneError for an invalid scene or invalid options.
RunResult simulate(const RunOptions& options);

/// Warnings: reasons not to rely on the run, one sentence each. Empty if all error estimates are small.
std::vector<std::string> doubts_of(const RunResult& result);
/// Document of --stats. The names of its keys are part of the interface.
Json statistics_of(const RunResult& result);
/// Table printed at the end of a run.
std::string summary_of(const RunResult& result);

}  // namespace skerry
