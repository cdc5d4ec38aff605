// What the program can do. Every command returns its exit code.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "skerry/problem.h"
#include "skerry/scene.h"

namespace skerry {

enum ExitCode : int {
    exit_ok = 0,
    exit_failed = 1,     // a step could not be committed, a problem did not converge
    exit_bad_input = 2,  // a file or the command line
};
inline constexpr int exit_signal = 128;  // plus the number of the signal

struct RunOptions {
    std::filesystem::path scene;
    std::optional<Real> seconds;
    std::optional<Real> frames_per_second;
    SceneOverrides overrides;
    std::filesystem::path out, stats, page, trace;  // empty: not written
    bool quiet = false;
};
int run(const RunOptions& options);

struct InspectOptions {
    std::filesystem::path file;
    bool json = false;
};
int inspect(const InspectOptions& options);

struct SolveOptions {
    std::filesystem::path problem, reactions;
    ProblemSettings settings;
    bool json = false;
};
int solve(const SolveOptions& options);

}  // namespace skerry
