// Solves a contact problem region by region. The caller gives the method: one of the library, or another one that a
// profiling program compares with it.
#pragma once

#include <functional>

#include "skerry/problem.h"
#include "systems/solver/methods/error_test.h"
#include "systems/solver/operators/block_operator.h"

namespace skerry {

/// A function that solves one region, starting from the present impulses of the operator.
using BlockMethod = std::function<SolveResult(BlockOperator&, const SolveLimits&)>;

/// Solves a problem like solve_problem, but with `method` in place of settings.method.
ProblemSolution solve_by_region(const ContactProblem& problem, const ProblemSettings& settings,
                                const BlockMethod& method);

}  // namespace skerry
