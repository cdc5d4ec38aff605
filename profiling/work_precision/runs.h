// Who runs a scene: our world, or the program of a peer.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "profiling/work_precision/record.h"

namespace skerry::profiling {

/// A choice of ours of which a curve is drawn.
struct SkerryVariant {
    std::string name;
    Settings settings{};  // step and gravity are set from the scene
    BodyDynamics dynamics = BodyDynamics::explicit_elastic;
};

/// The variants of the time axis: integrators, and tolerances of the contact solver. The last is the most precise;
/// references are taken with it.
std::vector<SkerryVariant> time_variants();

/// The stable step of the scene as it starts, s.
Real stable_step_of(const PrecisionScene& scene);

/// Runs the scene `repeat` times and times the steps alone. A step of 0 leaves it to the engine.
Record run_skerry(const PrecisionScene& scene, const SkerryVariant& variant, Real step, int repeat = 1,
                  double cap = 1e9);

/// The program of a peer, with the options that make one curve of it.
struct Peer {
    std::string engine;             // as in the table
    std::string variant;            // of its options
    std::string command;            // program and options
    bool explicit_step = false;     // its steps are bound to the mesh like ours
    bool explicit_damping = false;  // so are those of its damping: no use where there is much
};

/// Those whose programs are there. `programs` is the folder of the programs that were built; `python` starts MuJoCo's.
std::vector<Peer> find_peers(const std::filesystem::path& programs, const std::string& python);

/// Whether `python` can import the module.
bool has_module(const std::string& python, const std::string& module);

/// The command of a script that is here in profiling/work_precision.
std::string script_command(const std::string& python, const std::string& script);

/// Runs the scene in a process of its own, which may take `cap` CPU seconds a run. `folder` holds what is handed over.
Record run_peer(const PrecisionScene& scene, const Peer& peer, Real step, int repeat, double cap,
                const std::filesystem::path& folder);

}  // namespace skerry::profiling
