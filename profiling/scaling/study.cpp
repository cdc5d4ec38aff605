#include "profiling/scaling/study.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "engine/world/world_state.h"
#include "profiling/measure.h"
#include "profiling/scaling/quiet.h"
#include "profiling/scaling/recording_executor.h"

namespace skerry::profiling {

namespace {

void go_on_for(World& world, double seconds) {
    const StepReport report = world.advance(seconds);
    if (!report.ok()) throw std::runtime_error(report.message());
}

/// Advances in frames, so that steps have the same length as in a run.
void run_to(World& world, double time) {
    constexpr double frame = 1.0 / 60;
    while (time - world.time() > 1e-9) go_on_for(world, std::min(frame, time - world.time()));
}

/// A copy of the world that runs on an executor. Its first steps have let memory grow and caches fill.
class Copy {
public:
    Copy(const World& world, std::unique_ptr<Executor> executor, double warm_up) : world_(world.clone()) {
        WorldAccess::state_of(world_).executor = std::move(executor);
        go_on_for(world_, warm_up);
    }
    void go_on(double seconds) { go_on_for(world_, seconds); }
    /// Advances by `seconds` and returns the wall-clock time of each step [s].
    std::vector<double> measure(double seconds) {
        std::vector<double> steps;
        steps.reserve(1 << 16);
        double last = wall_seconds();
        world_.watch_steps([&](const StepReport&) {
            const double now = wall_seconds();
            steps.push_back(now - last);
            last = now;
        });
        go_on(seconds);
        world_.watch_steps({});
        return steps;
    }
    World& world() { return world_; }

private:
    World world_;
};

class Window {
public:
    Window(World& world, const StudyOptions& options)
        : world_(world), options_(options), step_(world.stable_step()), steps_(options.least_steps) {
        const double each = lower_fifth(measure(1));
        steps_ = std::max(steps_, static_cast<int>(options.window / each));
        hash_.reset();
    }

    void look(SceneStudy& study) {
        std::vector<Recording> recordings;
        for (int repeat = 0; repeat < options_.repeats; ++repeat)
            recordings.push_back(record(recordings, study, repeat == 0));
        append(undisturbed(recordings), study.recording);
        std::vector<Round> rounds;
        double patience = options_.wait;  // [s]
        for (int repeat = 0; repeat < options_.repeats; ++repeat) {
            patience -= wait_for_quiet(patience);
            rounds.push_back(measure_all());
        }
        rounds = least_disturbed(std::move(rounds));
        for (std::size_t k = 0; k < options_.threads.size(); ++k)
            study.measured[options_.threads[k]] += undisturbed_sum(rounds, k);
        for (const Round& round : rounds)
            study.others += round.others / static_cast<double>(rounds.size()) / options_.windows;
    }

private:
    static constexpr int warm_up_steps = 5;

    Recording record(const std::vector<Recording>& before, SceneStudy& study, bool counted) {
        auto owned = std::make_unique<RecordingExecutor>(options_.claimed_workers);
        RecordingExecutor& executor = *owned;
        Copy copy(world_, std::move(owned), warm_up_steps * step_);
        const std::uint64_t steps = copy.world().report().steps;
        executor.begin(before.empty() ? Recording{} : before.front());
        copy.go_on(steps_ * step_);
        Recording recording = executor.end();
        compare(copy.world());
        if (counted) count(copy.world(), copy.world().report().steps - steps, study);
        return recording;
    }

    std::vector<double> measure(int threads) {
        Copy copy(world_, make_executor(world_.settings().backend, threads), warm_up_steps * step_);
        std::vector<double> seconds = copy.measure(steps_ * step_);
        compare(copy.world());
        return seconds;
    }

    Round measure_all() {
        Round round;
        const OthersWatch others;
        for (const int threads : options_.threads) round.steps.push_back(measure(threads));
        round.others = others.cores();
        return round;
    }

    void compare(World& world) {
        const std::uint64_t hash = world.state_hash();
        if (hash_ && *hash_ != hash) throw std::runtime_error("runs of the same steps end in different states");
        hash_ = hash;
    }

    void count(World& world, std::uint64_t steps, SceneStudy& study) const {
        const WorldState& state = WorldAccess::state_of(world);
        study.steps += steps;
        study.contacts += static_cast<double>(state.scratch.contacts.size()) / options_.windows;
        study.regions += static_cast<double>(state.scratch.regions.size()) / options_.windows;
        for (std::size_t r = 0; r < state.scratch.regions.size(); ++r)
            study.largest_region =
                std::max(study.largest_region, static_cast<Index>(state.scratch.regions.contacts[r].size()));
    }

    World& world_;
    const StudyOptions& options_;
    double step_;  // [s]
    int steps_;    // number of steps of the window
    std::optional<std::uint64_t> hash_;
};

}  // namespace

SceneStudy study_scene(const std::string& name, World& world, double begin, double end, const StudyOptions& options) {
    SceneStudy study;
    study.name = name;
    for (int window = 0; window < options.windows; ++window) {
        run_to(world, begin + (end - begin) * (window + 0.5) / options.windows);
        Window(world, options).look(study);
        std::fprintf(stderr, "%s: %d of %d windows\n", name.c_str(), window + 1, options.windows);
    }
    const WorldReport report = world.report();
    study.tetrahedra = report.elements;
    study.bodies = report.bodies;
    for (const StageReport& stage : report.stages) study.stage_name.push_back(stage.name);
    const double bytes = options.bytes_per_tetrahedron * static_cast<double>(study.tetrahedra);
    study.traffic = {bytes * static_cast<double>(study.steps) / study.recording.work(), bytes};
    for (const int cores : options.cores)
        study.predicted[cores] = predict_seconds(study.recording, cores, options.machine, study.traffic);
    for (const int cores : options.costs)
        study.costs[cores] = stage_costs(study.recording, cores, options.machine, study.traffic);
    return study;
}

}  // namespace skerry::profiling
