// profile_solvers: runs every method on every contact problem, beside Siconos where it is installed. Writes a table
// (CSV) of seconds, iterations and errors for several tolerances. profiling/plot_solvers.py reads it.
//
// Skerry solves contacts of lumped masses twice: as general blocks, like Siconos, and as a step solves them ("METHOD,
// lumped"). The methods of the lab (profiling/lab) run in the same two ways. All methods run in one process and in
// turns, on one thread, each from r = 0 until its own test says that the tolerance is reached. The error in the table
// is measured apart, by problem_error. A Siconos or lumped solve that finishes, but misses the tolerance by this
// measure, is repeated with a smaller one. A laxer test of its own then does not count against it.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "profiling/associated.h"
#include "profiling/lab/solve_problem.h"
#include "profiling/lumped_solver.h"
#include "profiling/measure.h"
#include "profiling/siconos.h"
#include "profiling/solver_problems.h"
#include "skerry/error.h"

using namespace skerry;
using namespace skerry::profiling;

namespace {

struct Options {
    std::vector<std::string> inputs;
    std::vector<std::string> scenes{"scenes/skittles.json:393,524", "scenes/bucket.json:172,688"};
    std::string csv = "out/profiling/solvers/solvers.csv", associated;
    std::vector<Real> tolerances{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};
    std::vector<std::string> methods;
    Real cap = 2;  // [s]
    int rounds = 3;
    Index most_contacts = 1 << 30;
    bool quick = false, no_siconos = false, no_generated = false, no_scenes = false;
};

enum class Owner { skerry, skerry_lumped, siconos };

/// One method of Skerry on either operator, or one variant of Siconos.
struct Contestant {
    std::string name;
    Owner owner = Owner::skerry;
    std::variant<SolverMethod, lab::Method> method{};
    std::size_t variant = 0;
    Index most_contacts = 1 << 30;
    Index first_iterations = 20;
};

struct Result {
    double seconds = 0;
    Index iterations = 0;
    Real error = 0;
    bool finished = false;  // as reported by the solver
};

std::vector<Contestant> make_contestants(const Options& options) {
    std::vector<Contestant> all;
    const auto wanted = [&](const std::string& name) {
        return options.methods.empty() || std::ranges::find(options.methods, name) != options.methods.end();
    };
    const auto add = [&](auto method, std::string_view name, Owner owner) {
        const std::string full = std::string(name) + (owner == Owner::skerry_lumped ? ", lumped" : "");
        if (wanted(full) || wanted(std::string(name))) all.push_back({.name = full, .owner = owner, .method = method});
    };
    for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
        add(method, name, Owner::skerry);
        // Newton steps need a matrix, which the lumped operator makes only for checks.
        if (method != SolverMethod::newton) add(method, name, Owner::skerry_lumped);
    }
    for (const auto& [method, name] : EnumNames<lab::Method>::table)
        for (const Owner owner : {Owner::skerry, Owner::skerry_lumped}) add(method, name, owner);
    if (options.no_siconos) return all;
    const std::vector<SiconosVariant>& variants = siconos_variants();
    for (std::size_t v = 0; v < variants.size(); ++v)
        if (wanted(variants[v].name))
            all.push_back({.name = variants[v].name,
                           .owner = Owner::siconos,
                           .variant = v,
                           .most_contacts = variants[v].most_contacts,
                           .first_iterations = variants[v].first_iterations});
    return all;
}

/// A problem in the forms that the contestants take.
struct Forms {
    explicit Forms(const SolverProblem& given) : blocks(given.problem), siconos(given.problem) {
        if (!given.lumped) return;
        contacts = *given.lumped;
        lumped.emplace(*given.lumped);
    }
    const ContactProblem& blocks;
    SiconosProblem siconos;
    LumpedContacts contacts;
    std::optional<LumpedSolver> lumped;
};

Result solve_lumped(Forms& forms, const Contestant& contestant, Real tolerance, Index max_iterations) {
    SolverSettings settings{.warm_start = WarmStart::off, .tolerance = tolerance, .max_iterations = max_iterations};
    const lab::Method* const of_lab = std::get_if<lab::Method>(&contestant.method);
    if (of_lab == nullptr) settings.method = std::get<SolverMethod>(contestant.method);
    const double seconds = timed([&] { forms.lumped->reset(); },
                                 [&] {
                                     forms.lumped->separate();
                                     if (of_lab != nullptr)
                                         forms.lumped->solve(settings, *of_lab);
                                     else
                                         forms.lumped->solve(settings);
                                 });
    const RegionTable& regions = forms.lumped->regions();
    const bool finished =
        std::ranges::none_of(regions.status, [](RegionStatus s) { return s == RegionStatus::iteration_limit; });
    const std::vector<Vec3> reaction = in_contact_frames(forms.contacts, forms.lumped->impulse());
    return {seconds, forms.lumped->most_iterations(), problem_error(forms.blocks, reaction).relative, finished};
}

Result solve(Forms& forms, const Contestant& contestant, Real tolerance, Index max_iterations) {
    if (contestant.owner == Owner::siconos) {
        const SiconosSolution solution = forms.siconos.solve(contestant.variant, tolerance, max_iterations);
        return {solution.seconds, solution.iterations, problem_error(forms.blocks, solution.reaction).relative,
                solution.finished};
    }
    if (contestant.owner == Owner::skerry_lumped) return solve_lumped(forms, contestant, tolerance, max_iterations);
    ProblemSettings settings;
    settings.tolerance = tolerance;
    settings.max_iterations = max_iterations;
    const double start = cpu_seconds();
    const lab::Method* const of_lab = std::get_if<lab::Method>(&contestant.method);
    if (of_lab == nullptr) settings.method = std::get<SolverMethod>(contestant.method);
    const ProblemSolution solution =
        of_lab != nullptr ? lab::solve_problem(forms.blocks, *of_lab, settings) : solve_problem(forms.blocks, settings);
    const double cpu = cpu_seconds() - start;
    // A long solve is done once. The CPU time of the call is then an upper bound for the CPU time of the solve.
    const double seconds = solution.seconds < long_run ? solution.seconds : std::min(solution.seconds, cpu);
    return {seconds, solution.iterations, problem_error(forms.blocks, solution.reaction).relative, solution.converged};
}

bool leaves_friction_out(const Contestant& contestant) {
    const lab::Method* const of_lab = std::get_if<lab::Method>(&contestant.method);
    return of_lab != nullptr && lab::needs_frictionless(*of_lab);
}

/// State of one contestant on one problem while the tolerance gets smaller.
struct Standing {
    Index max_iterations = 0;  // number of iterations that the cap allows
    Real asked_less = 1;       // requested tolerance over the one to reach, below 1 if its own measure is laxer
    bool out = false;          // excluded, for example since it missed a larger tolerance
};

Index iterations_within(Forms& forms, const Contestant& contestant, Real cap) {
    const Result start = solve(forms, contestant, 1e-300, contestant.first_iterations);
    const double each = start.seconds / std::max<Index>(1, start.iterations);
    return static_cast<Index>(std::clamp(cap / std::max(each, 1e-9), 10.0, 1e7));
}

Result solve_to(Forms& forms, const Contestant& contestant, Real tolerance, Standing& standing) {
    Result result = solve(forms, contestant, standing.asked_less * tolerance, standing.max_iterations);
    const int retries = contestant.owner == Owner::siconos ? 3 : contestant.owner == Owner::skerry_lumped ? 10 : 0;
    for (int again = 0; again < retries && result.finished && result.error > tolerance; ++again) {
        standing.asked_less /= 4;
        result = solve(forms, contestant, standing.asked_less * tolerance, standing.max_iterations);
    }
    return result;
}

/// Writes rows of the table. `running` is the contestant whose turn it is.
void profile(const SolverProblem& given, const std::vector<Contestant>& contestants, const Options& options,
             volatile std::size_t& running, std::ostream& rows) {
    const ContactProblem& problem = given.problem;
    Forms forms(given);
    const bool frictionless = std::ranges::all_of(problem.mu, [](Real mu) { return mu == 0; });
    std::vector<Standing> standing(contestants.size());
    for (std::size_t c = 0; c < contestants.size(); ++c) {
        running = c;
        const bool possible = (contestants[c].owner != Owner::skerry_lumped || forms.lumped) &&
                              (frictionless || !leaves_friction_out(contestants[c]));
        standing[c].out = !possible || problem.contacts() > contestants[c].most_contacts;
        if (!standing[c].out) standing[c].max_iterations = iterations_within(forms, contestants[c], options.cap);
    }
    for (const Real tolerance : options.tolerances) {
        std::vector<Result> last(contestants.size());
        std::vector<std::vector<double>> seconds(contestants.size());
        for (int round = 0; round < options.rounds; ++round)
            for (std::size_t c = 0; c < contestants.size(); ++c) {
                // A solve that takes longer than a tenth of the cap is measured only once.
                if (standing[c].out ||
                    (round > 0 && (!(last[c].error <= tolerance) || last[c].seconds > options.cap / 10)))
                    continue;
                running = c;
                last[c] = solve_to(forms, contestants[c], tolerance, standing[c]);
                seconds[c].push_back(last[c].seconds);
            }
        constexpr const char* names[] = {"skerry", "skerry lumped", "siconos"};
        for (std::size_t c = 0; c < contestants.size(); ++c) {
            if (seconds[c].empty()) continue;
            const bool solved = last[c].error <= tolerance;
            const bool is_default =
                contestants[c].owner == Owner::skerry &&
                contestants[c].method == std::variant<SolverMethod, lab::Method>(ProblemSettings{}.method);
            rows << problem.name << ',' << given.origin << ',' << problem.contacts() << ','
                 << names[static_cast<int>(contestants[c].owner)] << ",\"" << contestants[c].name << '"' << ','
                 << is_default << ',' << tolerance << ',' << median(seconds[c]) << ',' << last[c].iterations << ','
                 << last[c].error << ',' << solved << ',' << last[c].finished << '\n';
            standing[c].out = !solved;
        }
    }
}

/// Calls profile() in a process of its own, since some of Siconos' solvers end the process on some problems. A
/// contestant that did so is left out, and the problem is done again.
void profile_apart(const SolverProblem& problem, std::vector<Contestant> contestants, const Options& options,
                   std::ofstream& csv) {
    void* shared = mmap(nullptr, sizeof(std::size_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) throw std::runtime_error("no shared memory");
    volatile std::size_t& running = *static_cast<std::size_t*>(shared);
    while (!contestants.empty()) {
        csv.flush();
        const pid_t child = fork();
        if (child < 0) throw std::runtime_error("no further process");
        if (child == 0) {
            std::ostringstream rows;
            profile(problem, contestants, options, running, rows);
            csv << rows.str() << std::flush;
            _exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
        std::fprintf(stderr, "\r\033[K%s ended the process on %s and is left out there\n",
                     contestants[running].name.c_str(), problem.problem.name.c_str());
        contestants.erase(contestants.begin() + static_cast<std::ptrdiff_t>(running));
    }
    munmap(shared, sizeof(std::size_t));
}

void run(const Options& options) {
    const std::vector<Contestant> contestants = make_contestants(options);
    const std::filesystem::path csv_file(options.csv);
    if (csv_file.has_parent_path()) std::filesystem::create_directories(csv_file.parent_path());
    std::ofstream csv(csv_file);
    std::optional<AssociatedTable> associated;
    if (!options.associated.empty()) associated.emplace(options.associated, options.tolerances, options.cap);
    csv << "problem,origin,contacts,owner,method,is_default,tolerance,seconds,iterations,error,converged,finished\n";
    const TakeProblem solve_one = [&](const SolverProblem& problem) {
        if (problem.problem.contacts() > options.most_contacts) return;
        std::fprintf(stderr, "\r\033[K%s, %d contacts", problem.problem.name.c_str(), problem.problem.contacts());
        profile_apart(problem, contestants, options, csv);
        if (associated) associated->add(problem.problem);
    };
    read_problems(options.inputs, solve_one);
    if (!options.no_scenes)
        for (const std::string& scene : options.scenes) step_problems(scene, solve_one);
    if (!options.no_generated) generated_problems(options.quick, solve_one);
    std::fprintf(stderr, "\r\033[K");
    std::printf("%s\n", options.csv.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Times every method on contact problems for several tolerances, beside Siconos where it is installed. Writes a "
        "CSV."};
    Options options;
    app.add_option("inputs", options.inputs,
                   "FCLIB files, and folders of them (the FCLIB collection of the Siconos project; skerry run "
                   "--export-problems); beside these, problems that this program makes itself")
        ->check(CLI::ExistingPath);
    app.add_option("--scenes", options.scenes, "Steps of scenes, each SCENE.json:STEP,STEP...")->capture_default_str();
    app.add_option("--csv", options.csv, "Where to write")->capture_default_str();
    app.add_option("--associated", options.associated,
                   "Also write a table (CSV) of solutions under the associated law (cone_convex), and how far they are "
                   "from Coulomb's");
    app.add_option("--tolerances", options.tolerances,
                   "From large to small; a method that misses one is not asked for the next")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--methods", options.methods, "Only these, ours and Siconos' alike")->delimiter(',');
    app.add_option("--cap", options.cap, "Seconds that a solve may take")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--rounds", options.rounds, "Rounds of all methods in turn; medians are written")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--most-contacts", options.most_contacts, "Leave out larger problems");
    app.add_flag("--quick", options.quick, "Three tolerances, one round, a cap of 0.1 s, no large generated problem");
    app.add_flag("--no-siconos", options.no_siconos, "Ours alone");
    app.add_flag("--no-generated", options.no_generated, "No problems made by rule");
    app.add_flag("--no-scenes", options.no_scenes, "No steps of scenes");
    CLI11_PARSE(app, argc, argv);
    if (options.quick) {
        if (app.count("--tolerances") == 0) options.tolerances = {1e-3, 1e-6, 1e-9};
        if (app.count("--rounds") == 0) options.rounds = 1;
        if (app.count("--cap") == 0) options.cap = 0.1;
        repeat_budget = 5e-3;
    }
    try {
        run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
