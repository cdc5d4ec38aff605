#include <algorithm>
#include <array>
#include <iostream>
#include <optional>
#include <ostream>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "engine/mesh/manifold_fault.h"
#include "engine/output/number_text.h"
#include "engine/program/checkpoint.h"
#include "engine/program/commands.h"
#include "engine/program/contact_area_text.h"
#include "engine/program/nearest_text.h"
#include "engine/program/plan_warnings.h"
#include "engine/program/progress.h"
#include "engine/program/ranks/run_ranks.h"
#include "engine/program/run_outputs.h"
#include "engine/program/run_plan.h"
#include "engine/program/run_result.h"
#include "engine/program/series_figures.h"
#include "engine/program/signal_guard.h"
#include "engine/program/stiff_note.h"
#include "engine/program/thin_part_text.h"
#include "engine/scene/scene_plan.h"
#include "jobs/executor.h"
#include "skerry/relax.h"
#include "skerry/tie.h"

namespace skerry {

namespace {

const char* const advice =
    "try a smaller --step; `skerry inspect SCENE` shows the stable step of every body, and overlaps at the start";

/// Simulates the frames of a run, beginning at the frame and sample that `memory` holds. An error is stored in
/// result.status. With several ranks all of them run this loop, and the world is gathered on rank 0 for each sample,
/// frame and checkpoint.
class FrameLoop {
public:
    /// Divides the world of the scene among the ranks. `outputs`: null on ranks other than 0.
    FrameLoop(Scene& scene, RunRanks& ranks, const RunOptions& options, const RunPlan& plan, RunMemory memory,
              RunOutputs* outputs, CheckpointWriter& checkpoints, RunResult& result)
        : ranks_(ranks),
          plan_(plan),
          memory_(std::move(memory)),
          outputs_(outputs),
          checkpoints_(checkpoints),
          result_(result),
          progress_(!options.quiet, plan.seconds, plan.steps(scene.world), plan.longest_step(scene.world),
                    scene.world.time()),
          probes_(scene),
          errors_(scene.world),
          figures_(options.series_figures && !scene.recorded.empty()
                       ? std::make_optional<SeriesFigures>(scene.world, scene.recorded)
                       : std::nullopt),
          world_(ranks.divide(scene, options.owners)) {}

    void run() {
        const SignalGuard guard;
        begin();
        const long first = memory_.frame;
        const double planned = std::exchange(memory_.seconds, plan_.seconds);
        int sample = memory_.sample;
        for (long frame = first; frame < plan_.frames() && result_.status == "ok"; ++frame, sample = 0) {
            const double length = plan_.length_of(frame);
            const bool longer = frame == first && cut_short(plan_, frame, planned);
            std::vector<double> ends = plan_.ends_in(frame);
            const auto is_past = [&](double end) { return !(end > world_.time() + slack_of_time()); };
            if (longer && !ends.empty()) sample = static_cast<int>(std::ranges::count_if(ends, is_past));
            const int calls = ends.empty() ? plan_.samples : static_cast<int>(ends.size());
            double duration = length / calls;
            if (longer && ends.empty())
                duration = (static_cast<double>(frame) * plan_.frame_step + length - world_.time()) / (calls - sample);
            const Real begin = world_.time();
            for (; sample < calls && result_.status == "ok"; ++sample) {
                if (sample > 0 && checkpoints_.due(world_.time())) write_checkpoint(frame, sample);
                advance(ends.empty() ? duration : ends[static_cast<std::size_t>(sample)] - world_.time());
            }
            if (result_.status != "ok" && !(world_.time() > begin))
                break;  // the run stopped before the first step of this frame, so the frame is not written
            add_frame();
            const bool full_frame = length >= (1 - RunPlan::slack) * plan_.frame_step;
            const bool due = frame + 1 == plan_.frames() || checkpoints_.due(world_.time());
            // A run that stopped within a call of advance() gets no checkpoint: advance() divides its duration into
            // equal steps, and a resumed run could not reproduce the remaining ones.
            if (result_.status == "ok" && due) write_checkpoint(full_frame ? frame + 1 : frame, 0);
        }
        result_.checkpoints = checkpoints_.written();
        result_.checkpoints_failed = checkpoints_.failed();
        result_.probes = probes_.records();
        result_.ranks = ranks_.report(result_.seconds_wall, steps_);
        if (const World* gathered = ranks_.gathered_world()) errors_.finish(*gathered);
        result_.errors = errors_.bodies();
        if (figures_) result_.series = figures_->all();
    }

private:
    /// Tolerance for rounding errors when the present time is compared with the end of a call of advance [s].
    double slack_of_time() const { return RunPlan::slack * plan_.longest_call(); }
    void begin() {
        ranks_.set_last_words(checkpoints_.last_words());
        result_.peak_kinetic_energy = memory_.peak_kinetic_energy;
        if (!result_.restarted_at)
            add_frame();
        else if (ranks_.is_first())
            probes_.go_on(memory_.probes);
    }
    void add_frame() {
        if (const World* gathered = ranks_.gathered_world()) {
            outputs_->add_frame(*gathered);
            result_.peak_kinetic_energy = std::max(result_.peak_kinetic_energy, gathered->energy().kinetic);
        }
        if (ranks_.any(result_.status == "ok" && outputs_ != nullptr && outputs_->all_failed()))
            result_.status =
                "stopped at " + short_text(world_.time(), 6) + " s, because none of the outputs can be written";
    }
    void advance(double duration) {
        const auto go_on = [&](const StepReport& so_far) {
            progress_.show(world_.time(), steps_ + static_cast<std::uint64_t>(so_far.steps));
            return caught_signal == 0;
        };
        const Stopwatch watch;
        const Real start = world_.time();
        ranks_.before_advance();
        const StepReport step = world_.advance(duration, go_on);
        ranks_.after_advance();
        result_.seconds_wall += watch.seconds();
        steps_ += static_cast<std::uint64_t>(step.steps);
        if (step.status == StepStatus::stopped)
            result_.status = "stopped by a signal at " + short_text(world_.time(), 6) + " s";
        else if (!step.ok())
            result_.status = step.message() + " (" + advice + ")";
        const Real sampled = step.ok() ? duration : world_.time() - start;
        if (!(sampled > 0)) return;
        const World* const gathered = ranks_.gathered_world();
        if (gathered == nullptr) return;
        probes_.sample(*gathered, sampled);
        outputs_->sample(*gathered);
        errors_.sample(*gathered);
        if (figures_) figures_->sample(*gathered);
    }
    void write_checkpoint(long frame, int sample) {
        memory_.frame = frame;
        memory_.sample = sample;
        memory_.seconds_wall = result_.seconds_wall;
        memory_.peak_kinetic_energy = result_.peak_kinetic_energy;
        memory_.probes = probes_.saved();
        const Stopwatch watch;
        if (checkpoints_.wanted()) checkpoints_.write(ranks_.gathered_world(), world_.time(), memory_);
        ranks_.set_last_words(checkpoints_.last_words());
        result_.seconds_output += watch.seconds();
    }

    RunRanks& ranks_;
    const RunPlan& plan_;
    RunMemory memory_;
    RunOutputs* outputs_;
    CheckpointWriter& checkpoints_;
    RunResult& result_;
    Progress progress_;
    ProbeRecorder probes_;
    ErrorEstimator errors_;
    std::optional<SeriesFigures> figures_;
    World& world_;             // the part of the world that this rank advances
    std::uint64_t steps_ = 0;  // number of steps since the run was started or resumed
};

/// Moves the bodies to a static equilibrium. If none is found, sets result.status to the reason, and the run ends
/// before its first step.
void start_from_rest(World& world, RunResult& result) {
    const SignalGuard guard;
    const Stopwatch watch;
    const RelaxSettings settings;
    const RelaxReport report = relax(world, settings, [](const RelaxReport&) { return caught_signal == 0; });
    const std::string steps = grouped(static_cast<std::size_t>(report.steps)) + " steps";
    if (report.converged)
        result.notes.push_back("the run starts from a static equilibrium, which took " + steps + " and " +
                               with_unit(watch.seconds(), "s") + " of wall time");
    else if (caught_signal != 0)
        result.status = "stopped by a signal before the start";
    else if (!report.message.empty())
        result.status = "--from-rest: found no equilibrium: " + report.message;
    else
        result.status = "--from-rest: found no equilibrium: after " + steps + " the out-of-balance force on body '" +
                        report.worst_name + "' is " + short_text(report.residual, 2) +
                        " of the forces on it, expected at most " + short_text(settings.tolerance);
}

void count_bodies(const World& world, RunResult& result) {
    const std::vector<BodyHandle> bodies = world.bodies();
    for (const BodyHandle body : bodies) {
        const BodyDynamics dynamics = world.dynamics(body);
        result.rigid_bodies += dynamics == BodyDynamics::rigid ? 1 : 0;
        result.implicit_bodies += dynamics == BodyDynamics::implicit_elastic ? 1 : 0;
        result.mean_edge += world.mean_edge(body) / static_cast<Real>(bodies.size());
    }
}

/// Returns one text for each combination of mesh, materials and kind of element with a part that is too stiff in
/// bending. The text names the first body with this combination. Rigid bodies and bodies that hardly deformed in the
/// run are left out.
std::vector<std::string> thin_parts(const ScenePlan& plan, const World& world, std::span<const ErrorEstimate> errors) {
    constexpr Real least_deformation = 0.01;  // a body is reported if at least this share of its motion is deformation
    std::vector<std::string> found;
    std::set<std::tuple<std::size_t, std::size_t, std::vector<std::pair<int, std::size_t>>, ElementKind>> seen;
    const std::vector<BodyHandle> bodies = bodies_in_order(world);
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
        const BodyPlan& body = plan.bodies[b];
        const auto error = std::ranges::find(errors, bodies[b], &ErrorEstimate::body);
        if (world.dynamics(bodies[b]) == BodyDynamics::rigid ||
            (error != errors.end() && error->deformation < least_deformation) ||
            !seen.emplace(body.mesh, body.material, body.materials, body.settings.element).second)
            continue;
        const std::string text =
            thin_part_text(plan.meshes[body.mesh], world.surface(bodies[b]), body_case_of(plan, body));
        if (!text.empty()) found.push_back("body '" + body.settings.name + "': " + text);
    }
    return found;
}

/// Returns one text for each mesh whose boundary is not a closed manifold. The text names one body with this mesh.
/// Where the boundary is not a manifold, contacts cannot distinguish the inside of a body from the outside.
std::vector<std::string> bad_boundaries(const ScenePlan& plan, const World& world) {
    std::vector<std::string> found;
    const std::vector<BodyHandle> bodies = bodies_in_order(world);
    std::vector<bool> seen(plan.meshes.size(), false);
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
        const BodyPlan& body = plan.bodies[b];
        if (seen[body.mesh]) continue;
        seen[body.mesh] = true;
        std::vector<BoundaryTriangle> boundary;
        for (const std::array<Index, 3>& node : world.surface(bodies[b])) boundary.push_back({node, no_index});
        const std::string fault = mesh::manifold_fault(boundary);
        if (!fault.empty())
            found.push_back("the boundary of body '" + body.settings.name + "' is not a closed manifold: " + fault +
                            (plan.mesh_files[body.mesh].empty() ? "" : " in " + plan.mesh_files[body.mesh].string()));
    }
    return found;
}

std::vector<BrokenTie> broken_ties(const ScenePlan& plan, World& world) {
    std::vector<BrokenTie> found;
    const Ties ties(world);
    const std::vector<TieHandle> handles = ties.all();
    for (std::size_t t = 0; t < plan.ties.size(); ++t) {
        const TieState state = ties.state(handles[t]);
        BrokenTie tie{.name = plan.ties[t].name, .nodes = state.nodes.size(), .largest_force = state.largest_force};
        for (const TiedNode& node : state.nodes) {
            if (!node.broken) continue;
            ++tie.broken;
            tie.first_time = std::min(tie.first_time, *node.broken);
            tie.last_time = std::max(tie.last_time, *node.broken);
        }
        if (tie.broken > 0) found.push_back(tie);
    }
    return found;
}

/// Progress and plan at the start of a run.
struct RunBeginning {
    RunMemory memory;
    RunPlan plan;
    double time = 0;  // [s]
    bool is_restart = false;
};

/// Builds the world of a scene, or takes it from a checkpoint, and plans the run. Called on rank 0 only.
Scene begin_run(const RunOptions& options, const ScenePlan& plan, std::optional<Restart>& restart,
                RunBeginning& beginning, RunResult& result) {
    SetupProgress setup(!options.quiet, plan);
    Scene scene = build_scene(plan, [&](std::size_t bodies) { setup.added(bodies); });
    World& world = scene.world;
    if (restart) {
        put_in_place(options.restart, std::move(restart->world), scene);
        beginning.memory = std::move(restart->memory);
        beginning.is_restart = true;
        result.restarted_at = world.time();
        result.seconds_wall = beginning.memory.seconds_wall;
    }
    if (options.from_rest) start_from_rest(world, result);
    RunMemory& memory = beginning.memory;
    memory.scene = std::filesystem::absolute(options.scene);
    memory.assignments = options.overrides.assignments;
    result.bad_boundaries = bad_boundaries(plan, world);
    result.plan_warnings = plan_warnings(plan);
    if (!options.quiet) print_lines("WARNING", result.plan_warnings);
    result.scene = scene.name;
    result.scene_file = options.scene.string();
    result.settings = world.settings();
    result.threads = make_executor(world.settings().backend, world.settings().threads)->worker_count();
    count_bodies(world, result);

    setup.begin("choosing the step length");
    beginning.time = world.time();
    beginning.plan = restart ? plan_run(options, memory, world.time())
                             : plan_run(scene, options.scene, options.seconds, options.frames_per_second);
    memory.frame_step = beginning.plan.frame_step;
    memory.samples = beginning.plan.samples;
    memory.probe_step = beginning.plan.probe_step;
    for (std::string& note : plan_notes(plan)) result.notes.push_back(std::move(note));
    if (const std::string note = stiff_note(plan, world, beginning.plan.steps(world), beginning.plan.longest_call());
        !note.empty())
        result.notes.push_back(note);
    if (!options.quiet) print_lines("NOTE", result.notes);
    return scene;
}

/// Scene of a rank other than 0, which gets its bodies from rank 0.
Scene scene_without_bodies(const ScenePlan& plan) {
    return {.name = plan.name,
            .description = {},
            .materials = {},
            .world = World({.backend = plan.settings.backend, .threads = plan.settings.threads}),
            .probes = {},
            .recorded = {}};
}

RunStart run_start(const RunBeginning& beginning, const World& world) {
    const RunPlan& plan = beginning.plan;
    return {.step_count = plan.steps(world),
            .frames = beginning.is_restart ? static_cast<std::size_t>(beginning.memory.frame) + 1 : 0,
            .frame_step = plan.frame_step,
            .row_step = plan.even() ? 0 : plan.probe_step};
}

/// Collective. Copies from rank 0 to all other ranks: `beginning`, and the status, time of restart and wall time so far
/// in `result`.
void share_beginning(const RunRanks& ranks, RunBeginning& beginning, RunResult& result) {
    const SignalGuard guard;  // otherwise a signal would kill ranks that wait here while rank 0 finds an equilibrium
    const RunPlan& plan = beginning.plan;
    const Json first = ranks.of_first({{"memory", to_json(beginning.memory)},
                                       {"plan", {plan.seconds, plan.frame_step, plan.samples, plan.probe_step}},
                                       {"time", beginning.time},
                                       {"is_restart", beginning.is_restart},
                                       {"status", result.status}});
    if (!ranks.is_first()) {
        const Json& numbers = first.at("plan");
        beginning = {.memory = memory_of("rank 0", first.at("memory").dump()),
                     .plan = {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<int>(),
                              numbers.at(3).get<double>()},
                     .time = first.at("time").get<double>(),
                     .is_restart = first.at("is_restart").get<bool>()};
        first.at("status").get_to(result.status);
        if (beginning.is_restart) result.restarted_at = beginning.time;
        result.seconds_wall = beginning.memory.seconds_wall;
    }
}

}  // namespace

RunResult simulate(const RunOptions& asked, RunRanks& ranks) {
    const Stopwatch loading;
    RunOptions options = ranks.options_for(asked);
    std::optional<Restart> restart;
    if (!options.restart.empty()) {
        if (ranks.is_first())
            restart = read_restart(options.restart, {options.overrides.backend, options.overrides.threads});
        const Json memory = ranks.of_first(restart ? to_json(restart->memory) : Json());
        if (options.scene.empty()) options.scene = memory.at("scene").get<std::string>();
        memory.at("assignments").get_to(options.overrides.assignments);
    }
    RunResult result;
    ScenePlan plan = plan_with_progress(options.scene, options.overrides, !options.quiet);
    result.seconds_load = loading.seconds();
    ranks.compare_starts(options.scene, options.overrides.assignments);
    const Stopwatch setting_up;
    RunBeginning beginning;
    Scene scene = ranks.is_first() ? begin_run(options, plan, restart, beginning, result) : scene_without_bodies(plan);
    World& world = scene.world;
    std::optional<RunOutputs> outputs;
    if (ranks.is_first())
        outputs.emplace(options, scene, run_start(beginning, world), result);
    else
        plan = {};  // frees the meshes of the plan, which only rank 0 needs
    share_beginning(ranks, beginning, result);
    const RunPlan& run_plan = beginning.plan;
    CheckpointWriter checkpoints(options.checkpoint, options.every.value_or(run_plan.seconds / 10), beginning.time);

    result.seconds_setup = setting_up.seconds();
    FrameLoop(scene, ranks, options, run_plan, std::move(beginning.memory), outputs ? &*outputs : nullptr, checkpoints,
              result)
        .run();
    result.stopped_by = caught_signal;
    if (!outputs) return result;

    result.report = world.report();
    result.ranks.complete(result.report);
    result.thin_parts = thin_parts(plan, world, result.errors);
    result.contact_areas = contact_area_texts(plan, world, result.errors);
    result.broken_ties = broken_ties(plan, world);
    if (result.report.steps > 0 && result.report.max_contacts == 0) result.nearest = nearest_text(world);
    if (std::string distrust = result.report.distrust(); result.status == "ok" && !distrust.empty()) {
        result.status = std::move(distrust);
        result.distrusted = true;
    }
    result.state_hash = world.state_hash();
    result.seconds_simulated = world.time();
    if (!checkpoints.failure().empty()) result.outputs_failed.emplace_back("--checkpoint", checkpoints.failure());
    outputs->finish(world);
    if (checkpoints.written() > 0) result.written.push_back(checkpoints.summary());
    return result;
}

namespace {

/// Prints the result of a run, and returns the exit code.
int conclude(const RunResult& result, const RunOptions& options) {
    const std::vector<std::string> warnings = warnings_of(result);
    if (options.quiet)
        for (const std::string& warning : warnings) std::cerr << "skerry: WARNING: " << warning << "\n";
    else
        std::cout << summary_of(result) << (options.profile ? details_of(result) : "") << std::flush;
    if (result.status != "ok") std::cerr << "skerry: " << result.status << "\n";
    if (result.stopped_by != 0) return exit_signal + result.stopped_by;
    if (!result.outputs_failed.empty()) return exit_output;
    if (result.distrusted) return exit_untrusted;
    return result.status == "ok" && (warnings.empty() || !options.strict) ? exit_ok : exit_failed;
}

}  // namespace

int run(const RunOptions& options) {
    RunRanks ranks;
    try {
        ranks = RunRanks::join();
        const RunResult result = simulate(options, ranks);
        const int code_of_signal = result.stopped_by != 0 ? exit_signal + result.stopped_by : exit_ok;
        return ranks.last_code(ranks.is_first() ? conclude(result, options) : code_of_signal);
    } catch (const std::exception& error) {
        return ranks.fail(error);
    }
}

}  // namespace skerry
