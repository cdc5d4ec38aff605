// Solves a problem region by region with any method for general blocks: methods of the library, or others that
// profiling compares with them.
#pragma once

#include <functional>

#include "skerry/problem.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/operators/block_operator.h"

namespace skerry {

/// Solves one region, starting from the operator's present impulse.
using BlockMethod = std::function<SolveResult(BlockOperator&, const SolveLimits&)>;

/// Solves a problem like solve_problem, with `method` in place of settings.method.
ProblemSolution solve_by_region(const ContactProblem& problem, const ProblemSettings& settings,
                                const BlockMethod& method);

}  // namespace skerry
