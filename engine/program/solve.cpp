#include <array>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <ostream>
#include <string>

#include "engine/base/write_file.h"
#include "engine/output/number_text.h"
#include "engine/program/commands.h"
#include "engine/program/require_writable.h"
#include "engine/scene/place.h"

namespace skerry {

namespace {

void write_reactions(const std::filesystem::path& file, const ProblemSolution& solution) {
    write_file(file, [&](std::ostream& out) {
        for (const Vec3& r : solution.reaction) {
            char line[96];
            std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", r.x(), r.y(), r.z());
            out << line;
        }
    });
}

Json to_json(const SolveOptions& options, const ContactProblem& problem, const ProblemSolution& solution) {
    return object_of({{"problem", problem.name},
                      {"contacts", problem.contacts()},
                      {"condensed_freedoms", problem.freedoms},
                      {"regions", solution.regions},
                      {"largest_region", solution.largest_region},
                      {"unconverged", solution.unconverged},
                      {"method", name_of(options.settings.method)},
                      {"friction", name_of(options.settings.friction)},
                      {"tolerance", options.settings.tolerance},
                      {"iterations", solution.iterations},
                      {"seconds", solution.seconds},
                      {"error", solution.error},
                      {"error_absolute", solution.error_absolute},
                      {"error_over_q", solution.error_over_q},
                      {"energy_gap", solution.energy_gap},
                      {"converged", solution.converged}});
}

std::string count(std::int64_t number) {
    return grouped(static_cast<std::uint64_t>(number));
}

void print(const SolveOptions& options, const ContactProblem& problem, const ProblemSolution& solution) {
    std::cout << problem.name << ": " << count(problem.contacts()) << " contacts in " << count(solution.regions)
              << " contact regions; the largest region has " << count(solution.largest_region) << " contacts\n";
    if (problem.freedoms > 0)
        std::cout << "  condensed     to the unknowns of the contacts, from " << count(problem.freedoms)
                  << " degrees of freedom\n";
    std::cout << "  method        " << name_of(options.settings.method) << ", " << name_of(options.settings.friction)
              << "\n"
              << "  iterations    " << count(solution.iterations) << " in " << with_unit(solution.seconds, "s") << "\n"
              << "  error         " << short_text(solution.error) << ", tolerance "
              << short_text(options.settings.tolerance) << " (absolute " << short_text(solution.error_absolute)
              << ", relative to |q| " << short_text(solution.error_over_q) << ")\n"
              << "  energy gap    " << with_unit(solution.energy_gap, "J") << "\n";
    if (!solution.converged) std::cout << "  not converged in " << count(solution.unconverged) << " contact regions\n";
}

}  // namespace

int solve(const SolveOptions& options) {
    const std::array<NamedFile, 2> files{{{"the problem", options.problem}, {"--reactions", options.reactions}}};
    require_distinct(files);
    const ContactProblem problem = read_problem(options.problem);
    if (!options.reactions.empty()) require_writable_file(options.reactions);
    const ProblemSolution solution = solve_problem(problem, options.settings);
    if (!options.reactions.empty()) write_reactions(options.reactions, solution);
    if (options.json)
        std::cout << to_json(options, problem, solution).dump(1) << "\n";
    else
        print(options, problem, solution);
    std::cout.flush();
    if (solution.converged) return exit_ok;
    std::cerr << "skerry: " << options.problem.string() << ": not converged after " << solution.iterations
              << " iterations; try a larger --max-iterations or another --method\n";
    return exit_failed;
}

}  // namespace skerry
