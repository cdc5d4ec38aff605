// Problems in blocks, from files for example, solved by the methods of the lab.
#pragma once

#include <functional>

#include "profiling/lab/associated_operator.h"
#include "profiling/lab/methods.h"
#include "skerry/problem.h"

namespace skerry::lab {

/// Solves a problem like skerry::solve_problem and ignores settings.method. Throws std::invalid_argument when the
/// method leaves friction out and the problem has some.
ProblemSolution solve_problem(const ContactProblem& problem, Method method, const ProblemSettings& settings);

using AssociatedMethod = std::function<SolveResult(AssociatedOperator&, const SolveLimits&)>;

/// The solution under the associated law of all contacts together, from r = 0. `error` and `energy_gap` (r . u, J) are
/// those of this law; problem_error gives those of Coulomb's. Of the settings tolerance, iterations and relaxation
/// count.
ProblemSolution solve_associated(const ContactProblem& problem, const AssociatedMethod& method,
                                 const ProblemSettings& settings);

}  // namespace skerry::lab
