// The commands of the program. Each of them returns its exit code.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "skerry/problem.h"
#include "skerry/scene.h"

namespace skerry {

enum ExitCode : int {
    exit_ok = 0,
    exit_failed = 1,     // a step could not be committed, a problem did not converge, or a strict run has warnings
    exit_bad_input = 2,  // error in a file or on the command line
    exit_output = 3,     // the computation succeeded but an output could not be written
};
inline constexpr int exit_signal = 128;  // the signal's number is added

/// Content of one file of exported contact problems.
enum class ProblemsOf { step, region };
template <>
struct EnumNames<ProblemsOf> {
    static constexpr std::array<std::pair<ProblemsOf, std::string_view>, 2> table{{
        {ProblemsOf::step, "step"},
        {ProblemsOf::region, "region"},
    }};
};

struct RunOptions {
    std::filesystem::path scene;  // may be empty with `restart`, which names the scene
    std::optional<Real> seconds;
    std::optional<Real> frames_per_second;
    SceneOverrides overrides;
    std::map<std::string, std::filesystem::path> outputs;  // place by option of output_formats(); empty: not written
    ProblemsOf problems_of = ProblemsOf::step;
    std::optional<int> problems_every;  // export interval [steps]
    bool quiet = false;
    bool profile = false;              // also print times, solver figures and other details at the end
    bool strict = false;               // warnings make the run fail
    std::filesystem::path checkpoint;  // empty: not written
    std::optional<Real> every;         // simulated time between two checkpoints [s]
    std::filesystem::path restart;     // checkpoint to resume from; empty: start from the scene's beginning
};
int run(const RunOptions& options);

struct InspectOptions {
    std::filesystem::path file;
    std::vector<std::string> assignments;  // PLACE=VALUE, for a scene
    bool json = false;
    std::filesystem::path repair;  // file for the repaired mesh; empty: no repair
    Real tolerance = 2e-3;   // largest distance between new and old surface, as a share of the bounding box's diagonal
    std::string body;        // body of the scene whose mesh is repaired; empty: the body that bounds the step
    bool overwrite = false;  // the repaired mesh may replace the file it was read from
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
    std::filesystem::path out;    // folder of the results; empty: out/NAME for the file NAME.json of cases
    std::optional<int> jobs;      // number of cases that run at a time
    std::optional<int> rank, of;  // rank of this process and number of processes that share the cases
    bool probes = false;          // also write the probe series of each case
    bool redo = false;            // results of other cases may be replaced
    bool dry_run = false;         // only lists the cases
    bool table = false;           // only write the table of the existing results
    bool strict = false;          // cases that fail, are refused or have warnings make the sweep fail
    bool quiet = false;
};
int sweep(const SweepOptions& options);

}  // namespace skerry
