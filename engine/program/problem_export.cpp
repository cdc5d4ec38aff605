#include "engine/program/problem_export.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/base/separate_outputs.h"
#include "engine/program/progress.h"
#include "skerry/problem.h"

namespace skerry {

namespace {

std::string numbered(const char* label, int digits, std::int64_t number) {
    char text[40];
    std::snprintf(text, sizeof text, "-%s%0*lld", label, digits, static_cast<long long>(number));
    return text;
}

/// Returns the number of steps from one exported step to the next, so that a run of `steps` steps exports about
/// `file_count` of them.
std::uint64_t default_every(double steps) {
    constexpr double file_count = 20;
    // The upper limit is needed because `steps` may be infinite, which has no integer value.
    return static_cast<std::uint64_t>(std::clamp(std::ceil(steps / file_count), 1.0, 1e18));
}

/// Removes a label and a number from the start of `text`. Returns no number if `text` starts differently.
std::optional<std::uint64_t> take_number(std::string_view& text, std::string_view label) {
    if (!text.starts_with(label)) return {};
    const char* const begin = text.data() + label.size();
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
    if (error != std::errc()) return {};
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
}

/// Number of the step if this is the name of an exported file of the scene.
std::optional<std::uint64_t> step_of_file(std::string_view name, const std::string& scene) {
    if (!name.starts_with(scene)) return {};
    name.remove_prefix(scene.size());
    const std::optional<std::uint64_t> step = take_number(name, "-step");
    if (!step || !take_number(name, "-contacts")) return {};
    take_number(name, "-region");
    return name == ".hdf5" ? step : std::nullopt;
}

/// Writes contact problems during the steps. If writing fails within a step, the next call of sample() or close()
/// throws the error.
class ExportedProblems final : public Writer {
public:
    ExportedProblems(const std::filesystem::path& folder, const std::string& scene, const RunOptions& options)
        : folder_(folder), scene_(scene), of_(options.problems_of), every_(options.problems_every) {}

    void open(World& world, const RunStart& start) override {
        const std::uint64_t steps = start.resumed() ? world.report().steps : 0;
        earlier_ = EarlierFiles(folder_, [&](const std::string& name) {
            const std::optional<std::uint64_t> step = step_of_file(name, scene_);
            return step && *step > steps;  // a resumed run keeps the problems of the steps before the checkpoint
        });
        const auto take = [this, &world](const StepProblem& step) {
            try {
                write_step(step);
            } catch (const std::exception&) {
                failure_ = std::current_exception();
                world.watch_contact_problems({});
            }
        };
        world.watch_contact_problems(take,
                                     every_ ? static_cast<std::uint64_t>(*every_) : default_every(start.step_count));
    }
    void sample(const World&) override { throw_failure(); }
    void close(const World&) override {
        throw_failure();
        earlier_.remove();
    }
    double seconds_in_steps() const override { return seconds_; }
    std::string written() const override {
        return std::to_string(files_) + " contact problems of " + std::to_string(steps_) + " steps to " +
               folder_.string();
    }

private:
    void throw_failure() const {
        if (failure_) std::rethrow_exception(failure_);
    }
    void write_step(const StepProblem& step);
    void write(ContactProblem problem, const StepProblem& step, const std::string& name, std::span<const Vec3> impulse);

    std::filesystem::path folder_;
    std::string scene_;
    ProblemsOf of_;
    std::optional<int> every_;  // number of steps between two exported steps; default: default_every()
    EarlierFiles earlier_;
    long files_ = 0, steps_ = 0;
    double seconds_ = 0;  // wall time of the export [s]
    std::exception_ptr failure_;
};

void ExportedProblems::write_step(const StepProblem& step) {
    const Stopwatch watch;
    earlier_.remove();
    const std::string name = scene_ + numbered("step", 6, static_cast<std::int64_t>(step.step));
    if (of_ == ProblemsOf::step) {
        write(step.problem, step, name + numbered("contacts", 1, step.problem.contacts()), step.impulse);
    } else {
        // Pairs (region, contact number). Sorting these pairs brings the contacts of each region together.
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

void ExportedProblems::write(ContactProblem problem, const StepProblem& step, const std::string& name,
                             std::span<const Vec3> impulse) {
    char about[160];
    std::snprintf(about, sizeof about, "step %llu at %.9g s, %.9g s long; ", static_cast<unsigned long long>(step.step),
                  step.time, step.step_size);
    problem.name = name;
    problem.description = scene_ + ": " + about + problem.description;
    write_problem(problem, folder_ / (name + ".hdf5"), impulse);
    ++files_;
}

}  // namespace

std::unique_ptr<Writer> exported_problems(const std::filesystem::path& folder, const Scene& scene,
                                          const RunOptions& options) {
    if (scene.name.empty() || scene.name.find_first_of("/\\") != std::string::npos)
        refuse_in(options.scene.string(), {}, "name", "\"" + scene.name + "\"", "a file name without / and \\",
                  "change \"name\" of the scene; the names of exported files begin with the name of the scene");
    return std::make_unique<ExportedProblems>(folder, scene.name, options);
}

}  // namespace skerry
