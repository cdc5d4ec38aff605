// Result of a run, and its presentation as JSON for scripts and as text for people.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/output/writer.h"
#include "engine/program/commands.h"
#include "engine/program/ranks/run_ranks.h"
#include "engine/scene/probe_recorder.h"
#include "skerry/estimate.h"
#include "skerry/scene.h"

namespace skerry {

/// A tie that has lost nodes.
struct BrokenTie {
    std::string name;
    std::size_t nodes = 0, broken = 0;          // numbers of tied nodes, and of those that have broken off
    Real first_time = infinity, last_time = 0;  // times at which the first and the last node broke off [s]
    Real largest_force = 0;                     // largest magnitude of the tie's total force in a step [N]
};

struct RunResult {
    std::string scene;
    std::string scene_file;
    std::string status = "ok";  // "ok", or the reason why the run stopped early or cannot be trusted
    bool distrusted = false;    // true if the run reached its end, but WorldReport::distrust() is not empty
    int stopped_by = 0;         // signal that stopped the run; 0 if there was none
    Settings settings;
    int threads = 0;  // number of threads of each rank
    RanksReport ranks;
    double seconds_simulated = 0;
    double seconds_wall = 0;    // wall time of all steps, including those before a restart [s]
    double seconds_load = 0;    // wall time for reading the scene and its meshes [s]
    double seconds_setup = 0;   // wall time between reading the scene and the first frame [s]
    double seconds_output = 0;  // wall time for writing outputs and checkpoints [s]
    int frames = 0;
    std::optional<double> restarted_at;           // time of the checkpoint from which the run resumed [s]
    int checkpoints = 0, checkpoints_failed = 0;  // numbers written and failed since the start or restart
    std::size_t rigid_bodies = 0, implicit_bodies = 0;
    Real peak_kinetic_energy = 0;  // largest kinetic energy at the end of a frame [J]
    Real mean_edge = 0;            // mean edge length of the surfaces, averaged over the bodies [m]
    WorldReport report;
    std::vector<ErrorEstimate> errors;  // estimates by body; in a resumed run for the part after the checkpoint
    std::uint64_t state_hash = 0;
    std::vector<ProbeRecord> probes;
    std::vector<BrokenTie> broken_ties;
    // option and error message of each output that failed
    std::vector<std::pair<std::string, std::string>> outputs_failed;
    std::vector<std::string> plan_warnings;   // warnings about values in the scene
    std::vector<std::string> bad_boundaries;  // one sentence for each mesh whose boundary is not a closed manifold
    std::vector<std::string> thin_parts;      // one sentence for each mesh that is too stiff in bending
    std::vector<std::string> contact_areas;   // one sentence for each body with a mesh too coarse for its contacts
    std::vector<std::string> notes;           // remarks about the input that do not question the result
    std::string nearest;                      // result of nearest_text() for a run without any contact, else empty
    std::vector<std::pair<std::string, double>> series;  // figures of the time series of the probes, see SeriesFigures
    std::vector<std::string> written;                    // description of each written output
};

/// Simulates a scene and writes the requested outputs. Throws SceneError if the scene or an option is invalid. With
/// several ranks all of them call this function. The result is complete on rank 0.
RunResult simulate(const RunOptions& options, RunRanks& ranks);

/// Returns the reasons not to rely on the results of the run, one sentence with a remedy for each. Returns an empty
/// list if there are none.
std::vector<std::string> warnings_of(const RunResult& result);
/// Returns the JSON document of --stats. Scripts rely on the names of its keys.
Json statistics_of(const RunResult& result);
/// Writer for the JSON document of --stats, which is written when the run ends. `result` must outlive the writer.
std::unique_ptr<Writer> statistics_file(const std::filesystem::path& file, const RunResult& result);
/// Returns the short text that is printed at the end of a run.
std::string summary_of(const RunResult& result);
/// Returns the additional lines for --profile: step limits, solver statistics, energies, times of the stages, state
/// hash.
std::string details_of(const RunResult& result);

}  // namespace skerry
