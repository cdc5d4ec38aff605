#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <ostream>

#include "engine/mesh/manifold_fault.h"
#include "engine/output/write_file.h"
#include "engine/program/commands.h"
#include "engine/program/problem_export.h"
#include "engine/program/progress.h"
#include "engine/program/require_writable.h"
#include "engine/program/run_result.h"
#include "engine/scene/scene_plan.h"
#include "jobs/executor.h"
#include "skerry/error.h"
#include "skerry/output.h"

namespace skerry {

namespace {

volatile std::sig_atomic_t caught_signal = 0;

/// Ctrl-C and polite kills end the run between two frames; a second one ends it at once.
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

struct Course {
    double seconds, frame_step;
    int samples;  // of the probes in a frame
};

Course course_of(const RunOptions& options, const Scene& scene) {
    Course course{options.seconds.value_or(scene.seconds), scene.frame_step, 1};
    if (options.frames_per_second) course.frame_step = 1 / *options.frames_per_second;
    const auto complain_of = [&](const char* field, double count, const char* hint) {
        char found[64];
        std::snprintf(found, sizeof found, "%g of them", count);
        Complaint{.file = options.scene.string(),
                  .object = "run",
                  .field = field,
                  .found = found,
                  .expected = "at most 1e9",
                  .hint = hint}
            .raise();
    };
    constexpr double most = 1e9;
    if (const double frames = course.seconds / course.frame_step; !(frames <= most))
        complain_of("frames", frames, "seconds times frames per second: seconds, frame_step");
    if (scene.probes.empty()) return course;
    const double samples = std::min(course.frame_step, course.seconds) / scene.probe_step;
    if (!(samples <= most)) complain_of("samples of the probes in a frame", samples, "probe_step");
    course.samples = std::max(1, static_cast<int>(std::lround(samples)));
    return course;
}

/// About how many steps a run takes: samples are cut into equal steps.
double steps_of(const Course& course, const World& world) {
    const double sample = course.frame_step / course.samples;
    const Real stable = world.stable_step() * world.settings().step_safety;
    const Real longest = std::min(stable, world.settings().step_size.value_or(stable));
    return course.seconds / sample * std::ceil(sample / longest);
}

/// Runs frame after frame. What went wrong is in result.status.
void run_frames(Scene& scene, const Course& course, FrameOutput& output, bool show_progress, RunResult& result) {
    const SignalGuard guard;
    Progress progress(show_progress, course.seconds);
    ProbeRecorder probes(scene);
    World& world = scene.world;
    constexpr double slack = 1e-9;  // of a frame: 0.1 s are six frames of 1/60 s, not seven
    const auto frame_count = std::max(1L, static_cast<long>(std::ceil(course.seconds / course.frame_step - slack)));
    output.add_frame(world);
    result.peak_kinetic_energy = world.energy().kinetic;
    for (long frame = 0; frame < frame_count && result.status == "ok"; ++frame) {
        const double begin = static_cast<double>(frame) * course.frame_step;
        const double length = std::min(course.frame_step, course.seconds - begin);
        for (int sample = 0; sample < course.samples; ++sample) {
            const Stopwatch watch;
            const double duration = length / course.samples;
            const StepReport step = world.advance(duration);
            result.seconds_wall += watch.seconds();
            if (!step.ok()) {
                result.status = step.message() + " (" + advice + ")";
                break;
            }
            probes.sample(world, duration);
        }
        output.add_frame(world);
        result.peak_kinetic_energy = std::max(result.peak_kinetic_energy, world.energy().kinetic);
        progress.show(world.time());
        if (caught_signal != 0) result.status = "stopped by a signal at " + std::to_string(world.time()) + " s";
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
    } else {
        for (const std::string& doubt : doubts_of(result)) std::cerr << "skerry: DOUBT: " << doubt << "\n";
    }
}

/// One of each mesh. Contacts find the way out of a body by its surface: where that has no two sides they may not.
std::vector<std::string> bad_boundaries(const ScenePlan& plan) {
    std::vector<std::string> found;
    std::size_t last = plan.meshes.size();
    for (const BodyPlan& body : plan.bodies) {
        if (body.mesh == last) continue;
        last = body.mesh;
        const std::string fault = mesh::manifold_fault(boundary_triangles(plan.meshes[body.mesh].tetrahedra));
        if (!fault.empty())
            found.push_back("the boundary of body '" + body.settings.name + "' is not a closed manifold: " + fault);
    }
    return found;
}

}  // namespace

int run(const RunOptions& options) {
    const Stopwatch loading;
    const ScenePlan plan = plan_scene(options.scene, options.overrides);
    Scene scene = build_scene(plan);
    World& world = scene.world;
    RunResult result;
    result.bad_boundaries = bad_boundaries(plan);
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
    const Course course = course_of(options, scene);
    FrameOutput output(options, scene);
    if (!options.trace.empty()) world.set_tracing(true);

    ProblemExport problems(options, scene.name);
    if (!options.problems.empty()) problems.watch(world, steps_of(course, world));

    run_frames(scene, course, output, !options.quiet, result);

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
