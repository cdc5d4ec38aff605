#include "profiling/lab/solve_problem.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "engine/problem/solve_by_region.h"
#include "profiling/measure.h"

namespace skerry::lab {

ProblemSolution solve_problem(const ContactProblem& problem, Method method, const ProblemSettings& settings) {
    if (needs_frictionless(method) && std::ranges::any_of(problem.mu, [](Real mu) { return mu != 0; }))
        throw std::invalid_argument("problem " + problem.name + " has friction, which " + std::string(name_of(method)) +
                                    " leaves out");
    return solve_by_region(problem, settings,
                           [method](BlockOperator& op, const SolveLimits& limits) { return run(method, op, limits); });
}

ProblemSolution solve_associated(const ContactProblem& problem, const AssociatedMethod& method,
                                 const ProblemSettings& settings) {
    const BlockSystem system{problem.row_offset, problem.column, problem.block, problem.q, problem.mu};
    std::vector<Index> order(problem.q.size());
    std::iota(order.begin(), order.end(), Index{0});
    ProblemSolution solution;
    const double start = profiling::wall_seconds();
    BlockMemory memory;
    memory.prepare(system, order);
    AssociatedOperator op(memory, system, order);
    const SolveResult result = method(op, {.tolerance = settings.tolerance,
                                           .max_iterations = settings.max_iterations,
                                           .relaxation = settings.relaxation});
    solution.seconds = profiling::wall_seconds() - start;
    solution.iterations = result.iterations;
    solution.error = op.error();
    solution.converged = solution.error <= settings.tolerance;
    std::vector<Vec4> pull(order.size());  // -u
    op.residual(pull);
    for (std::size_t i = 0; i < order.size(); ++i) {
        solution.energy_gap -= memory.impulse[i].dot(pull[i]);
        solution.reaction.push_back(memory.impulse[i].head<3>());
    }
    return solution;
}

}  // namespace skerry::lab
