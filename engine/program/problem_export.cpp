#include "engine/program/problem_export.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "engine/program/progress.h"
#include "skerry/problem.h"

namespace skerry {

namespace {

std::string numbered(const char* what, int digits, std::int64_t number) {
    char text[40];
    std::snprintf(text, sizeof text, "-%s%0*lld", what, digits, static_cast<long long>(number));
    return text;
}

/// Returns the export interval [steps] for which about `file_count` steps are written.
std::uint64_t default_every(double steps) {
    constexpr double file_count = 20;
    // a run may have infinitely many steps
    return static_cast<std::uint64_t>(std::clamp(std::ceil(steps / file_count), 1.0, 1e18));
}

}  // namespace

ProblemExport::ProblemExport(const RunOptions& options, std::string scene)
    : options_(options), scene_(std::move(scene)) {
    if (!options.problems.empty() && (scene_.empty() || scene_.find_first_of("/\\") != std::string::npos))
        Complaint{.file = options.scene.string(),
                  .object = {},
                  .field = "name",
                  .found = "\"" + scene_ + "\"",
                  .expected = "a file name without a folder",
                  .hint = "exported problems bear the name of the scene"}
            .raise();
}

std::uint64_t ProblemExport::every(double steps_to_come) const {
    return options_.problems_every ? static_cast<std::uint64_t>(*options_.problems_every)
                                   : default_every(steps_to_come);
}

void ProblemExport::write_step(const StepProblem& step) {
    const Stopwatch watch;
    const std::string name = scene_ + numbered("step", 6, static_cast<std::int64_t>(step.step));
    if (options_.problems_of == ProblemsOf::step) {
        write(step.problem, step, name + numbered("contacts", 1, step.problem.contacts()), step.impulse);
    } else {
        // sorts contacts by region, and regions by number
        std::vector<std::pair<Index, Index>> order;
        for (std::size_t i = 0; i < step.region.size(); ++i) order.emplace_back(step.region[i], static_cast<Index>(i));
        std::sort(order.begin(), order.end());
        for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
            std::vector<Index> contacts;
            std::vector<Vec3> impulse;
            for (; end < order.size() && order[end].first == order[begin].first; ++end) {
                contacts.push_back(order[end].second);
                impulse.push_back(step.impulse[order[end].second]);
            }
            write(part_of(step.problem, contacts), step,
                  name + numbered("contacts", 1, static_cast<std::int64_t>(contacts.size())) +
                      numbered("region", 4, order[begin].first),
                  impulse);
        }
    }
    ++steps_;
    seconds_ += watch.seconds();
}

void ProblemExport::write(ContactProblem problem, const StepProblem& step, const std::string& name,
                          std::span<const Vec3> impulse) {
    char about[160];
    std::snprintf(about, sizeof about, "step %llu at %.9g s, %.9g s long; ", static_cast<unsigned long long>(step.step),
                  step.time, step.step_size);
    problem.name = name;
    problem.description = scene_ + ": " + about + problem.description;
    write_problem(problem, options_.problems / (name + ".hdf5"), impulse);
    ++files_;
}

}  // namespace skerry
