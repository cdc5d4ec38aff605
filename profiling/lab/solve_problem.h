// Solution of problems in blocks, for example from files, with the methods of the lab.
#pragma once

#include <functional>

#include "profiling/lab/associated_operator.h"
#include "profiling/lab/methods.h"
#include "skerry/problem.h"

namespace skerry::lab {

/// Solves a problem like skerry::solve_problem and ignores settings.method. Throws std::invalid_argument if the method
/// ignores friction and the problem has friction.
ProblemSolution solve_problem(const ContactProblem& problem, Method method, const ProblemSettings& settings);

using AssociatedMethod = std::function<SolveResult(AssociatedOperator&, const SolveLimits&)>;

/// Solves all contacts together under the associated law, from r = 0. `error` and `energy_gap` (r . u [J]) are those of
/// this law; problem_error gives those of Coulomb's. Only tolerance, max_iterations and relaxation of the settings are
/// used.
ProblemSolution solve_associated(const ContactProblem& problem, const AssociatedMethod& method,
                                 const ProblemSettings& settings);

}  // namespace skerry::lab
