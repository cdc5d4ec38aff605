// Result of a run, and its presentations: JSON for scripts and text for people.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/output/writer.h"
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
    std::size_t rigid_bodies = 0, implicit_bodies = 0;
    Real peak_kinetic_energy = 0;  // largest value of all frames [J]
    Real mean_edge = 0;            // mean over the bodies' surfaces [m]
    WorldReport report;
    std::uint64_t state_hash = 0;
    std::vector<ProbeRecord> probes;
    std::vector<std::pair<std::string, std::string>> outputs_failed;  // option and error
    std::vector<std::string> bad_boundaries;                          // one sentence for each invalid mesh boundary
    std::vector<std::string> written;                                 // the written files, as texts for the user
};

/// Carries out a run with its outputs. Throws SceneError for an invalid scene or invalid options.
RunResult simulate(const RunOptions& options);

/// Reasons not to rely on the run, each with its remedy, one sentence each. Empty if all error estimates are small.
std::vector<std::string> warnings_of(const RunResult& result);
/// Document of --stats. The names of its keys are part of the interface.
Json statistics_of(const RunResult& result);
/// Writes this document when it is closed. `result` must outlive the writer.
std::unique_ptr<Writer> statistics_file(const std::filesystem::path& file, const RunResult& result);
/// Short text printed at the end of a run.
std::string summary_of(const RunResult& result);
/// Additional lines for --profile: step lengths, solver, energies, times of the stages, state hash.
std::string details_of(const RunResult& result);

}  // namespace skerry
