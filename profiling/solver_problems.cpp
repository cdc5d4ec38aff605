#include "profiling/solver_problems.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>

#include "profiling/generate_problem.h"
#include "skerry/scene.h"

namespace skerry::profiling {
namespace {

std::vector<std::filesystem::path> problem_files(const std::vector<std::string>& inputs) {
    std::vector<std::filesystem::path> files;
    for (const std::filesystem::path input : inputs) {
        if (!std::filesystem::is_directory(input)) {
            files.push_back(input);
            continue;
        }
        std::vector<std::filesystem::path> inside;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(input))
            if (entry.path().extension() == ".hdf5") inside.push_back(entry.path());
        std::ranges::sort(inside);
        files.insert(files.end(), inside.begin(), inside.end());
    }
    return files;
}

std::set<std::uint64_t> read_steps(const std::string& text, const std::string& all) {
    std::set<std::uint64_t> steps;
    std::istringstream stream(text);
    for (std::string step; std::getline(stream, step, ',');) {
        std::size_t used = 0;
        const std::uint64_t number = step.empty() ? 0 : std::stoull(step, &used);
        if (number == 0 || used != step.size())
            throw std::invalid_argument("'" + step + "' in '" + all + "' is no step");
        steps.insert(number);
    }
    return steps;
}

}  // namespace

void read_problems(const std::vector<std::string>& inputs, const TakeProblem& take) {
    for (const std::filesystem::path& file : problem_files(inputs)) {
        ContactProblem problem = read_problem(file);
        problem.name = file.stem().string();
        take({std::filesystem::absolute(file).parent_path().filename().string(), std::move(problem), {}});
    }
}

void step_problems(const std::string& scene_and_steps, const TakeProblem& take) {
    const std::size_t colon = scene_and_steps.rfind(':');
    if (colon == std::string::npos)
        throw std::invalid_argument("'" + scene_and_steps + "' is not of the form SCENE.json:STEP,STEP");
    const std::filesystem::path file = scene_and_steps.substr(0, colon);
    std::set<std::uint64_t> wanted = read_steps(scene_and_steps.substr(colon + 1), scene_and_steps);
    Scene scene = load_scene(file, {.threads = 1, .backend = Backend::serial});
    scene.world.watch_contact_problems(
        [&](const StepProblem& step) {
            if (wanted.erase(step.step) == 0) return;
            SolverProblem problem{"scenes", step.problem, step.lumped};
            problem.problem.name = file.stem().string() + "-" + std::to_string(step.step);
            take(problem);
        },
        1);
    while (!wanted.empty() && scene.world.time() < scene.seconds) {
        const StepReport report = scene.world.advance(scene.frame_step);
        if (!report.ok()) throw std::runtime_error(file.string() + ": " + report.message());
    }
    if (!wanted.empty())
        throw std::runtime_error(file.string() + ": step " + std::to_string(*wanted.begin()) +
                                 " has no contacts, or the scene ends before it");
}

void generated_problems(bool quick, const TakeProblem& take) {
    for (const NamedContacts& named : generate_problems(quick))
        take({"generated", assemble_problem(named.contacts, named.name), named.contacts});
}

}  // namespace skerry::profiling
