// The problems that profile_solvers runs: FCLIB files, steps of scenes, and problems made by rule.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

struct SolverProblem {
    std::string origin;
    ContactProblem problem;
    std::optional<LumpedContacts> lumped;  // where it has that form
};

using TakeProblem = std::function<void(const SolverProblem&)>;

/// Files, and files in folders, in the order of their names.
void read_problems(const std::vector<std::string>& inputs, const TakeProblem& take);

/// Of a scene "FILE:STEP,STEP...", the contact problems of those steps, tolerance and solver as the scene has them.
void step_problems(const std::string& scene_and_steps, const TakeProblem& take);

void generated_problems(bool quick, const TakeProblem& take);

}  // namespace skerry::profiling
