#include <algorithm>
#include <csignal>
#include <iostream>
#include <ostream>

#include "engine/mesh/manifold_fault.h"
#include "engine/program/commands.h"
#include "engine/program/course.h"
#include "engine/program/number_text.h"
#include "engine/program/progress.h"
#include "engine/program/run_outputs.h"
#include "engine/program/run_result.h"
#include "engine/scene/scene_plan.h"
#include "jobs/executor.h"

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

/// Runs frame after frame. What went wrong is in result.status.
void run_frames(Scene& scene, const Course& course, RunOutputs& outputs, Progress& progress, RunResult& result) {
    const SignalGuard guard;
    ProbeRecorder probes(scene);
    World& world = scene.world;
    std::uint64_t steps = 0;
    const auto go_on = [&](const StepReport& so_far) {
        progress.show(world.time(), steps + static_cast<std::uint64_t>(so_far.steps));
        return caught_signal == 0;
    };
    const auto add_frame = [&] {
        outputs.add_frame(world);
        result.peak_kinetic_energy = std::max(result.peak_kinetic_energy, world.energy().kinetic);
        if (result.status == "ok" && outputs.all_failed())
            result.status = "stopped at " + short_number(world.time(), 6) + " s: no output is left that can be written";
    };
    add_frame();
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
        add_frame();
    }
    result.probes = probes.records();
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
    const std::vector<BodyHandle> bodies = world.bodies();
    for (const BodyHandle body : bodies) result.mean_edge += world.mean_edge(body) / static_cast<Real>(bodies.size());

    const Course course = course_of(scene, options);
    RunOutputs outputs(options, scene);
    if (!options.trace.empty()) world.set_tracing(true);
    outputs.watch(world, course.steps(world));

    {
        Progress progress(!options.quiet, course.seconds, course.steps(world), course.longest_step(world));
        run_frames(scene, course, outputs, progress, result);
    }

    result.report = world.report();
    result.state_hash = world.state_hash();
    result.seconds_simulated = world.time();
    result.seconds_wall -= outputs.seconds_in_steps();
    outputs.finish(world, result);
    if (options.quiet)
        for (const std::string& doubt : doubts_of(result)) std::cerr << "skerry: DOUBT: " << doubt << "\n";
    else
        std::cout << summary_of(result) << outputs.summary() << std::flush;
    if (result.status != "ok") std::cerr << "skerry: " << result.status << "\n";
    if (caught_signal != 0) return exit_signal + caught_signal;
    if (!result.outputs_failed.empty()) return exit_output;
    return result.status == "ok" ? exit_ok : exit_failed;
}

}  // namespace skerry
