#include "profiling/associated.h"

#include <algorithm>
#include <utility>

#include "profiling/lab/solve_problem.h"
#include "systems/solver/methods/ags.h"
#include "systems/solver/methods/pgs.h"

namespace skerry::profiling {
namespace {

struct NamedMethod {
    const char* name;
    lab::AssociatedMethod solve;
};

const NamedMethod methods[] = {
    {"pgs", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return solve_pgs(op, limits); }},
    {"ags", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return solve_ags(op, limits); }},
    {"nncg", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return lab::solve_nncg(op, limits); }},
    {"apgd", [](lab::AssociatedOperator& op, const SolveLimits& limits) { return lab::solve_apgd(op, limits); }},
};

/// Number of iterations that take about `cap` seconds.
Index iterations_within(const ContactProblem& problem, const NamedMethod& method, Real cap) {
    constexpr Index first = 20;
    const ProblemSolution start =
        lab::solve_associated(problem, method.solve, {.tolerance = 0, .max_iterations = first});
    const double each = std::max(start.seconds / std::max<Index>(1, start.iterations), 1e-9);
    return static_cast<Index>(std::clamp(cap / each, 10.0, 1e7));
}

}  // namespace

AssociatedTable::AssociatedTable(const std::filesystem::path& file, std::vector<Real> tolerances, Real cap)
    : csv_(file), tolerances_(std::move(tolerances)), cap_(cap) {
    csv_ << "problem,contacts,method,tolerance,seconds,iterations,error,coulomb_error\n";
}

void AssociatedTable::add(const ContactProblem& problem) {
    for (const NamedMethod& method : methods) {
        const Index most = iterations_within(problem, method, cap_);
        for (const Real tolerance : tolerances_) {
            const ProblemSolution solution =
                lab::solve_associated(problem, method.solve, {.tolerance = tolerance, .max_iterations = most});
            csv_ << problem.name << ',' << problem.contacts() << ',' << method.name << ',' << tolerance << ','
                 << solution.seconds << ',' << solution.iterations << ',' << solution.error << ','
                 << problem_error(problem, solution.reaction).relative << '\n';
            if (!solution.converged) break;
        }
    }
}

}  // namespace skerry::profiling
