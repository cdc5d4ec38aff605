// Runs of a scene: by Skerry, or by the program of another engine (a peer).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/world/tuning.h"
#include "profiling/work_precision/record.h"

namespace skerry::profiling {

/// Settings of Skerry for one curve of a plot.
struct SkerryVariant {
    std::string name;
    Settings settings{};  // step size and gravity are set from the scene
    Tuning tuning{};
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;
};

/// Variants of the time axis: integrators, and tolerances of the contact solver. The last is the most precise and
/// computes the references.
std::vector<SkerryVariant> time_variants();

/// Stable step of the scene as it starts [s].
Real stable_step_of(const PrecisionScene& scene);

/// Runs the scene `repeat` times and times only the steps. A `step` of 0 leaves the step size to the engine. A run that
/// takes more than `cap` CPU seconds ends unfinished.
Record run_skerry(const PrecisionScene& scene, const SkerryVariant& variant, Real step, int repeat = 1,
                  double cap = 1e9);

/// Program of a peer, with the options of one curve.
struct Peer {
    std::string engine;             // name in the table
    std::string variant;            // name of its options
    std::string command;            // program and options
    bool explicit_step = false;     // the mesh limits its step size, as for Skerry
    bool explicit_damping = false;  // damping limits the step size, too: unusable with strong damping
};

/// Returns the peers whose programs are installed. `programs` is the folder of the programs that were built. `python`
/// starts MuJoCo's script.
std::vector<Peer> find_peers(const std::filesystem::path& programs, const std::string& python);

/// True if `python` can import the module.
bool has_module(const std::string& python, const std::string& module);

/// Command that runs a script of profiling/work_precision.
std::string script_command(const std::string& python, const std::string& script);

/// Runs the scene in a separate process, which may take `cap` CPU seconds per run. `folder` holds the exchanged files.
Record run_peer(const PrecisionScene& scene, const Peer& peer, Real step, int repeat, double cap,
                const std::filesystem::path& folder);

}  // namespace skerry::profiling
