#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "profiling/generate_problem.h"
#include "profiling/lab/solve_problem.h"
#include "profiling/separation.h"

namespace skerry::profiling {
namespace {

/// A problem of a scene or a generated one, with the name of its kind.
struct Case {
    std::string kind;
    ContactProblem problem;
};

std::vector<Case> gather_cases(const std::vector<StepProblem>& steps, int seeds) {
    std::vector<Case> cases;
    for (const StepProblem& step : steps)
        cases.push_back({step.problem.name.substr(0, step.problem.name.find('-')), step.problem});
    for (int seed = 1; seed <= seeds; ++seed) {
        const std::uint64_t number = static_cast<std::uint64_t>(seed);
        const auto add = [&](const char* kind, const SheetSettings& settings) {
            cases.push_back(
                {kind, assemble_problem(generate_sheets(settings), kind + std::string("-") + std::to_string(seed))});
        };
        add("patch of 8", {.nodes = 4, .seed = number});
        add("patch of 72", {.nodes = 8, .seed = number});
        add("patch of 72 with mass ratio 100", {.nodes = 8, .mass_ratio = 100, .seed = number});
        add("stack of 96 in 4 layers", {.sheets = 4, .nodes = 6, .stacked = true, .seed = number});
    }
    return cases;
}

}  // namespace

void profile_cone(const SeparationOptions& options, const std::vector<StepProblem>& steps) {
    std::ofstream csv(options.out / "cone.csv");
    csv << "kind,problem,contacts,method,tolerance,cone_iterations,pyramid_iterations,cone_seconds,pyramid_seconds\n";
    const std::vector<Case> cases = gather_cases(steps, options.quick ? 3 : 20);
    std::fprintf(stderr, "\r\033[Kcone against pyramid, %zu problems", cases.size());
    for (const Case& test_case : cases)
        for (const SolverMethod method : {SolverMethod::pgs, SolverMethod::pcg_pgs})
            for (const Real tolerance : {1e-3, 1e-6}) {
                ProblemSettings settings{
                    .method = method, .friction = Friction::cone, .tolerance = tolerance, .max_iterations = 3000};
                const ProblemSolution cone = solve_problem(test_case.problem, settings);
                settings.friction = Friction::pyramid;
                const ProblemSolution pyramid = solve_problem(test_case.problem, settings);
                if (!cone.converged || !pyramid.converged || cone.iterations < 2) continue;  // nothing to compare
                csv << test_case.kind << ',' << test_case.problem.name << ',' << test_case.problem.contacts() << ','
                    << name_of(method) << ',' << tolerance << ',' << cone.iterations << ',' << pyramid.iterations << ','
                    << cone.seconds << ',' << pyramid.seconds << '\n';
            }
}

void profile_poor_cases(const SeparationOptions& options, const std::vector<StepProblem>& steps) {
    std::ofstream csv(options.out / "poor.csv");
    csv << "kind,problem,contacts,method,limit,error\n";
    const std::vector<Case> cases = gather_cases(steps, options.quick ? 5 : 50);
    std::fprintf(stderr, "\r\033[Kpoor cases, %zu problems", cases.size());
    for (const Case& test_case : cases)
        for (const Index limit : {50, 200}) {
            ProblemSettings settings{.tolerance = 1e-6, .max_iterations = limit};
            const auto write = [&](std::string_view name, const ProblemSolution& solution) {
                csv << test_case.kind << ',' << test_case.problem.name << ',' << test_case.problem.contacts() << ','
                    << name << ',' << limit << ',' << solution.error << '\n';
            };
            for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
                settings.method = method;
                write(name, solve_problem(test_case.problem, settings));
            }
            for (const auto& [method, name] : EnumNames<lab::Method>::table)
                if (!lab::needs_frictionless(method))
                    write(name, lab::solve_problem(test_case.problem, method, settings));
        }
}

}  // namespace skerry::profiling
