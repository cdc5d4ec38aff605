// Problems of profile_solvers: FCLIB files, steps of scenes, and generated problems.
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
    std::optional<LumpedContacts> lumped;  // only if the problem has that form
};

using TakeProblem = std::function<void(const SolverProblem&)>;

/// Reads files, and files in folders in the order of their names.
void read_problems(const std::vector<std::string>& inputs, const TakeProblem& take);

/// Takes the contact problems of some steps of a scene, given as "FILE:STEP,STEP...". Tolerance and solver are those of
/// the scene.
void step_problems(const std::string& scene_and_steps, const TakeProblem& take);

void generated_problems(bool quick, const TakeProblem& take);

}  // namespace skerry::profiling
