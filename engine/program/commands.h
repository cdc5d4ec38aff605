// What the program can do. Every command returns its exit code.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "skerry/problem.h"
#include "skerry/scene.h"

namespace skerry {

enum ExitCode : int {
    exit_ok = 0,
    exit_failed = 1,     // a step could not be committed, a problem did not converge, a strict run is doubted
    exit_bad_input = 2,  // a file or the command line
    exit_output = 3,     // all is well but an output, which could not be written
};
inline constexpr int exit_signal = 128;  // plus the number of the signal

/// What one file of exported contact problems holds.
enum class ProblemsOf { step, region };
template <>
struct EnumNames<ProblemsOf> {
    static constexpr std::array<std::pair<ProblemsOf, std::string_view>, 2> table{{
        {ProblemsOf::step, "step"},
        {ProblemsOf::region, "region"},
    }};
};

struct RunOptions {
    std::filesystem::path scene;  // may be empty with `restart`, which names it
    std::optional<Real> seconds;
    std::optional<Real> frames_per_second;
    SceneOverrides overrides;
    std::filesystem::path out, stats, page, trace, problems, probes;  // empty: not written
    ProblemsOf problems_of = ProblemsOf::step;
    std::optional<int> problems_every;  // steps
    bool quiet = false;
    bool strict = false;               // what speaks against relying on the run is a failure
    std::filesystem::path checkpoint;  // empty: not written
    std::optional<Real> every;         // s, simulated, between two checkpoints
    std::filesystem::path restart;     // a checkpoint to go on from; empty: from the scene's beginning
};
int run(const RunOptions& options);

struct InspectOptions {
    std::filesystem::path file;
    std::vector<std::string> assignments;  // PLACE=VALUE, of a scene
    bool json = false;
    std::filesystem::path repair;  // where a better mesh goes; empty: none is made
    Real tolerance = 2e-3;         // of the bounding box's diagonal: how far its surface may be from the old one
    std::string body;              // of a scene, whose mesh is mended; empty: that which bounds the step
    bool overwrite = false;        // the repaired mesh may take the place of the file it comes from
};
int inspect(const InspectOptions& options);

struct SolveOptions {
    std::filesystem::path problem, reactions;
    ProblemSettings settings;
    bool json = false;
};
int solve(const SolveOptions& options);

struct SweepOptions {
    std::filesystem::path cases;
    std::filesystem::path out;    // folder of the results; empty: out/NAME of the file of cases
    std::optional<int> jobs;      // cases at a time
    std::optional<int> rank, of;  // of several processes that share the cases
    bool probes = false;          // the series of each case, beside its result
    bool redo = false;            // results of other cases may be replaced
    bool dry_run = false;         // only lists the cases
    bool table = false;           // only makes the table of what is there
    bool strict = false;          // cases that fail, are refused or doubted are a failure
    bool quiet = false;
};
int sweep(const SweepOptions& options);

}  // namespace skerry
