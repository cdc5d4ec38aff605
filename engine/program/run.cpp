#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <ostream>

#include "engine/output/write_file.h"
#include "engine/program/commands.h"
#include "engine/program/course.h"
#include "engine/program/number_text.h"
#include "engine/program/problem_export.h"
#include "engine/program/progress.h"
#include "engine/program/require_writable.h"
#include "engine/program/run_result.h"
#include "jobs/executor.h"
#include "skerry/error.h"
#include "skerry/output.h"

namespace skerry {

namespace {

volatile std::sig_atomic_t caught_signal = 0;

/// Ctrl-C and polite kills end the run between two steps; a second one ends it at once.
class SignalGuard {
public:
    SignalGuard() {
        struct sigaction action = {};
        action.sa_handler = [](int number) { caught_signal = number; };
        action.sa_flags = static_cast<int>(SA_RESETHAND);
        sigaction(SIGINT, &action, &old_interrupt_);
        sigaction(SIGTERM, &action, &old_terminate_);
    }
    ~SignalGuard() {
        sigaction(SIGINT, &old_interrupt_, nullptr);
        sigaction(SIGTERM, &old_terminate_, nullptr);
    }
    SignalGuard(const SignalGuard&) = delete;
    SignalGuard& operator=(const SignalGuard&) = delete;

private:
    struct sigaction old_interrupt_, old_terminate_;
};

const char* const advice =
    "on the command line: a smaller --step; `skerry inspect` shows the stable step of every body and what overlaps";

/// What is written while a run goes on.
class FrameOutput {
public:
    FrameOutput(const RunOptions& options, const Scene& scene) {
        if (!options.out.empty()) vtk_ = std::make_unique<VtkWriter>(options.out, scene.name);
        if (!options.page.empty()) page_ = std::make_unique<PageWriter>(options.page, scene.name);
    }
    void add_frame(const World& world) {
        const Stopwatch watch;
        if (vtk_) vtk_->write_frame(world);
        if (page_) page_->add_frame(world);
        ++frames_;
        seconds_ += watch.seconds();
    }
    void close(const World& world) {
        const Stopwatch watch;
        if (vtk_) vtk_->close();
        if (page_) page_->close(world);
        seconds_ += watch.seconds();
    }
    int frames() const { return frames_; }
    double seconds() const { return seconds_; }

private:
    std::unique_ptr<VtkWriter> vtk_;
    std::unique_ptr<PageWriter> page_;
    int frames_ = 0;
    double seconds_ = 0;
};

/// Runs frame after frame. What went wrong is in result.status.
void run_frames(Scene& scene, const Course& course, FrameOutput& output, Progress& progress, RunResult& result) {
    const SignalGuard guard;
    ProbeRecorder probes(scene);
    World& world = scene.world;
    std::uint64_t steps = 0;
    const auto go_on = [&](const StepReport& so_far) {
        progress.show(world.time(), steps + static_cast<std::uint64_t>(so_far.steps));
        return caught_signal == 0;
    };
    output.add_frame(world);
    result.peak_kinetic_energy = world.energy().kinetic;
    for (long frame = 0; frame < course.frames() && result.status == "ok"; ++frame) {
        const Real begin = world.time();
        const double duration = course.length_of(frame) / course.samples;
        for (int sample = 0; sample < course.samples && result.status == "ok"; ++sample) {
            const Stopwatch watch;
            const Real start = world.time();
            const StepReport step = world.advance(duration, go_on);
            result.seconds_wall += watch.seconds();
            steps += static_cast<std::uint64_t>(step.steps);
            if (step.status == StepStatus::stopped)
                result.status = "stopped by a signal at " + short_number(world.time(), 6) + " s";
            else if (!step.ok())
                result.status = step.message() + " (" + advice + ")";
            const Real sampled = step.ok() ? duration : world.time() - start;
            if (sampled > 0) probes.sample(world, sampled);
        }
        if (result.status != "ok" && !(world.time() > begin)) break;  // the frame before shows all there is
        output.add_frame(world);
        result.peak_kinetic_energy = std::max(result.peak_kinetic_energy, world.energy().kinetic);
    }
    result.probes = probes.records();
}

void write_results(const RunOptions& options, const RunResult& result, const ProblemExport& problems,
                   const World& world) {
    if (!options.stats.empty())
        write_file(options.stats, [&](std::ostream& out) { out << statistics_of(result).dump(1) << "\n"; });
    if (!options.trace.empty()) write_file(options.trace, [&](std::ostream& out) { world.write_trace(out); });
    if (!options.quiet) {
        std::cout << summary_of(result);
        for (const auto* file : {&options.out, &options.page, &options.stats, &options.trace})
            if (!file->empty()) std::cout << "  wrote         " << file->string() << "\n";
        if (!options.problems.empty())
            std::cout << "  wrote         " << problems.files() << " contact problems of " << problems.steps()
                      << " steps to " << options.problems.string() << "\n";
        std::cout.flush();
    }
}

}  // namespace

int run(const RunOptions& options) {
    const Stopwatch loading;
    Scene scene = load_scene(options.scene, options.overrides);
    World& world = scene.world;
    RunResult result;
    result.seconds_load = loading.seconds();
    result.scene = scene.name;
    result.scene_file = options.scene.string();
    result.settings = world.settings();
    result.threads = make_executor(world.settings().backend, world.settings().threads)->worker_count();
    for (const BodyHandle body : world.bodies())
        result.mean_edge += world.mean_edge(body) / static_cast<Real>(world.bodies().size());

    for (const auto* folder : {&options.out, &options.problems})
        if (!folder->empty()) require_writable_folder(*folder);
    for (const auto* file : {&options.stats, &options.page, &options.trace})
        if (!file->empty()) require_writable_file(*file);
    const std::array<NamedFile, 4> files{{{"the scene", options.scene},
                                          {"--page", options.page},
                                          {"--stats", options.stats},
                                          {"--trace", options.trace}}};
    require_distinct(files);
    const Course course = course_of(scene, options);
    FrameOutput output(options, scene);
    if (!options.trace.empty()) world.set_tracing(true);

    ProblemExport problems(options, scene.name);
    if (!options.problems.empty()) problems.watch(world, course.steps(world));

    {
        Progress progress(!options.quiet, course.seconds, course.steps(world), course.longest_step(world));
        run_frames(scene, course, output, progress, result);
    }

    result.report = world.report();
    result.state_hash = world.state_hash();
    result.seconds_simulated = world.time();
    output.close(world);
    result.frames = output.frames();
    // problems are written within the steps
    result.seconds_wall -= problems.seconds();
    result.seconds_output = output.seconds() + problems.seconds();
    write_results(options, result, problems, world);
    if (result.status == "ok") return exit_ok;
    std::cerr << "skerry: " << result.status << "\n";
    return caught_signal != 0 ? exit_signal + caught_signal : exit_failed;
}

}  // namespace skerry
