// The loop that divides a time interval into steps, and its reaction when a step cannot be taken.
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/kernels.h"
#include "engine/world/ranks/act_together.h"
#include "engine/world/ranks/hold/ghosts.h"
#include "engine/world/step/step.h"
#include "jobs/arithmetic_scope.h"

namespace skerry {

namespace {

/// Number of steps in a round, which evaluates the stable step of each body once (docs/methods/stable_step.md 6). So a
/// stable step in use is at most two rounds old. With clusters (groups of nodes that implicit elements couple), longer
/// steps deform elements more, so rounds are shorter.
std::uint64_t steps_per_round(const WorldState& world) {
    return world.model.clusters.empty() && !world.model.of_ranks.has_clusters ? 128u : 64u;
}

/// Counts a step of the present round. At the end of a round, the newly evaluated stable steps replace the old ones.
/// Returns true at the end of every second round, when the energy balance must be checked.
bool keep_watch(WorldState& world) {
    StepWatch& watch = world.model.watch;
    ++watch.steps;
    if (watch.steps < steps_per_round(world)) return false;
    // The clusters must be updated first, because stable steps depend on them.
    Balance& balance = world.ranks.on() ? world.ranks.share.balance : world.record.balance;
    balance.work += follow_stiffening(world.model);
    balance.work += use_evaluated_steps(world.model, world.scratch.stiffness_sum);
    reduce_limits(world);
    send_clustered_bodies(world);
    watch.second = !watch.second;
    return !watch.second;
}

/// Returns the upper limit of the step length for the first attempt at a step in a call of advance, and the body that
/// causes it. The limit follows from the element that deforms fastest at the start of the call, which must not deform
/// too much in the step (slow_enough()).
AttemptLimits limits_of_first_attempt(WorldState& world) {
    const Model& model = world.model;
    const Real longest = longest_allowed_step(model), max_strain_step = model.tuning.max_strain_step;
    if (!std::isfinite(longest)) return {};
    constexpr bool pushed = false;
    CheckInputs state = CheckInputs::bind(Binder(), model.node_blocks, model.bodies, model.nodes, model.tetrahedra,
                                          model.elements, model.element_nodes, pushed);
    state.velocity_next = model.nodes.velocity;
    const StrainRate fastest = fastest_of_ranks(
        world, kernels().strain_rate(*world.executor, state, max_strain_step / longest, world.scratch.beside_fast));
    return {.slow_enough = slow_enough(fastest, max_strain_step, longest), .fastest = fastest.body};
}

StepStatus status_of(StepFault fault) {
    switch (fault) {
        case StepFault::not_finite:
            return StepStatus::not_finite;
        case StepFault::too_fast:
            return StepStatus::too_fast;
        case StepFault::too_far:
            return StepStatus::too_far;
        case StepFault::too_stiff:
            return StepStatus::too_stiff;
        case StepFault::unsolved:
            return StepStatus::unsolved;
        case StepFault::none:
            break;
    }
    return StepStatus::ok;
}

void blame(const WorldState& world, StepReport& report) {
    const StepVerdict& verdict = world.scratch.findings.verdict;
    report.status = status_of(verdict.fault);
    report.value = verdict.value;
    if (verdict.body == no_index) return;
    const auto [handle, name] = name_body(world, verdict.body);
    report.body = handle;
    report.body_name = name;
    report.node = verdict.node;
    report.element = verdict.tetrahedron;
    // with ranks, the node and element numbers of the findings are already local to the body
    if (world.ranks.on()) return;
    const auto b = static_cast<std::size_t>(verdict.body);
    if (verdict.node != no_index) report.node -= world.model.bodies.nodes[b].begin;
    if (verdict.tetrahedron != no_index) report.element = world.model.user_tetrahedron(b, verdict.tetrahedron);
}

void add_to_report(const RunCounters& step, StepReport& report) {
    report.contacts = static_cast<Index>(step.contact_sum);
    report.regions = static_cast<Index>(step.solved);
    report.largest_region = step.largest_region;
    report.unconverged += static_cast<Index>(step.unconverged);
    if (step.worst_error > report.worst_error) {
        report.worst_error = step.worst_error;
        report.worst_region = step.worst_region;
    }
    report.max_penetration = std::max(report.max_penetration, step.max_penetration);
    report.max_gap_violation = std::max(report.max_gap_violation, step.max_gap_violation);
    ++report.steps;
}

void note_held(const HeldDepth& held, WorldState& world, StepReport& report) {
    report.held_penetration = std::max(report.held_penetration, held.depth);
    world.record.held.take(held);
}

void note_outcome(StepOutcome outcome, RunCounters& counters, StepReport& report) {
    report.retried += outcome == StepOutcome::again_with_crossings;
    counters.retried += outcome == StepOutcome::again_with_crossings;
    report.shortened += outcome == StepOutcome::again_shorter;
    counters.shortened += outcome == StepOutcome::again_shorter;
}

void note_inversions(WorldState& world, StepReport& report) {
    const Inversions& inversions = world.scratch.findings.inversions;
    if (inversions.count == 0) return;
    if (report.inverted == 0) {
        const auto [handle, name] = name_body(world, inversions.body);
        report.inverted_body = handle;
        report.inverted_name = name;
        report.inverted_element =
            world.ranks.on()
                ? inversions.tetrahedron
                : world.model.user_tetrahedron(static_cast<std::size_t>(inversions.body), inversions.tetrahedron);
    }
    report.inverted += inversions.count;
    world.record.counters.inversions += static_cast<std::uint64_t>(inversions.count);
}

/// If a body would be unstable at Settings::step_size, so that the step was shorter, counts the step and names the body
/// in the report.
void note_limit(WorldState& world, StepReport& report) {
    if (!world.model.settings.step_size) return;
    Index body = no_index;
    const Real trusted = longest_allowed_step(world.model, &body);
    body = world_row_of_stiffest(world, body);
    if (body == no_index || *world.model.settings.step_size <= trusted) return;
    ++report.limited;
    ++world.record.counters.limited;
    report.limited_step = trusted;
    report.limited_by = name_body(world, body).name;
}

/// Adds a committed step to the report of the call.
void note_committed_step(WorldState& world, StepReport& report) {
    report.step_size = world.scratch.parameters.h;
    add_to_report(world.scratch.counters, report);
    note_held(held_in_shapes(world, report.steps == 1), world, report);
    note_inversions(world, report);
    note_limit(world, report);
}

/// Completes a committed step: updates drawn nodes, releases broken ties and adds the step to the report.
/// `let_through`: number of crossings that were accepted in all earlier steps.
void complete_step(WorldState& world, std::uint64_t let_through, StepReport& report) {
    world.drawn_behind = world.scratch.parameters.draws_late;
    if (world.scratch.findings.rest.bodies > 0) world.draw(true);
    if (world.scratch.findings.released_ties > 0) release_ties(world);
    report.crossed += static_cast<Index>(world.cache.crossings.let_through - let_through);
    note_committed_step(world, report);
}

/// Checks surfaces for self-crossings, and the energy balance. Must be called after every second round of steps.
/// Returns false if the balance must be checked later, because positions are ahead of velocities (leapfrog).
bool check_after_rounds(WorldState& world) {
    world.draw();
    if (!world.scratch.skipped)
        find_self_crossings(*world.executor, world.model, world.clock.time, world.scratch.self_crossing_places,
                            world.record.self_crossings);
    if (world.clock.offset != 0) return false;
    check_balance_after_motion(world);
    return true;
}

/// Returns true, and sets the verdict, if the next step would be so short that adding it to the time could change
/// nothing (rounding). `end`: time at the end of the call [s].
bool is_too_stiff(WorldState& world, const AttemptLimits& attempt, Real end) {
    Index stiffest = no_index;
    const Real trusted = longest_allowed_step(world.model, &stiffest);
    if (std::min(trusted, attempt.at_most()) > std::numeric_limits<Real>::epsilon() * end) return false;
    world.scratch.findings.verdict = {StepFault::too_stiff, world_row_of_stiffest(world, stiffest), no_index, trusted};
    return true;
}

/// Limits the next attempt so that no body with a joint or tie rotates too far.
void limit_turns(const WorldState& world, AttemptLimits& attempt) {
    Index row = no_index;
    const Real step = step_of_turns(world.model, attempt.slow_enough, row);
    if (!(step < attempt.slow_enough)) return;
    attempt.slow_enough = step;
    attempt.fastest = row == no_index ? world.model.of_ranks.spinning : world.ranks.world_row_of(row);
}

/// Fetches ghosts (copies of bodies of other ranks), if the last attempt has shown that this is necessary: a rank
/// lacked bodies, or bodies may have moved to where other ranks need them. Otherwise does nothing and returns false.
bool fetch_ghosts(WorldState& world) {
    if (!world.ranks.all_findings.bodies_missing && !world.ranks.all_findings.ghosts_expired) return false;
    // The discarded forces contain impulses by which clusters (implicitly integrated groups of nodes) have stiffened.
    // The next attempt must stiffen the same clusters again.
    world.transaction.restore_stiffness(world.model);
    update_ghosts(world);
    world.scratch.parameters.h = 0;  // marks the forces as unknown, because new ghosts have none
    return true;
}

/// Throws SceneError if a call would need more steps than an int can count. Such steps may also be too short to advance
/// the time, so that the call would never end.
void require_countable(const WorldState& world, Real dt) {
    const Model& model = world.model;
    constexpr Real most = std::numeric_limits<int>::max();
    Index body = no_index;
    const Real stable = stable_step(model, &body) * model.tuning.step_safety;
    const Real step = model.settings.step_size.value_or(stable);
    if (!(dt > most * step)) return;
    body = world_row_of_stiffest(world, body);
    const bool of_body = !model.settings.step_size && body != no_index;
    refuse("advance", "dt",
           short_text(dt) + " s in steps of " + short_text(step) + " s" +
               (of_body ? ", the stable step of body '" + name_body(world, body).name + "'" : std::string()),
           "at most 2147483647 steps",
           of_body ? "check the size and material of this body" : "use a shorter dt or a larger step_size");
}

/// Calls functions of the user. If one of them throws, stores the exception until the end of advance(), when the world
/// is in a valid state.
class Callbacks {
public:
    /// Returns the result of call(); false if it throws.
    bool run(auto&& call) {
        try {
            return call();
        } catch (...) {
            thrown_ = std::current_exception();
            return false;
        }
    }
    void rethrow() const {
        if (thrown_) std::rethrow_exception(thrown_);
    }

private:
    std::exception_ptr thrown_;
};

/// Sets WorldState::advancing during the lifetime of this object. The destructor clears it even if an exception is
/// thrown.
class AdvanceScope {
public:
    explicit AdvanceScope(bool& advancing) : advancing_(advancing) { advancing_ = true; }
    ~AdvanceScope() { advancing_ = false; }
    AdvanceScope(const AdvanceScope&) = delete;
    AdvanceScope& operator=(const AdvanceScope&) = delete;

private:
    bool& advancing_;
};

/// Does the work of World::advance, after settle_start() has treated overlaps.
StepReport take_steps(WorldState& world, Real dt, const std::function<bool(const StepReport&)>& go_on,
                      Callbacks& callbacks) {
    Model& model = world.model;
    Clock& clock = world.clock;
    SearchMemory& search = world.cache.search.memory;
    const bool leapfrog = model.settings.integrator == Integrator::leapfrog;
    world.settle();
    note_changed_seams(model);
    settle_clusters(model, world.scratch.stiffness_sum);
    reduce_limits(world);
    require_countable(world, dt);
    StepReport report;
    const Real end = clock.time + dt;
    Real remaining = dt;
    AttemptLimits attempt = limits_of_first_attempt(world);
    // Crossings that are still stored belong to a step that the last call of advance gave up. Bodies may have changed
    // since then.
    world.cache.crossings.row.clear();
    if (world.record.counters.steps == 0 && remaining > 0)
        check_balance(world, clock.time, lag_between_steps(world), world.record.balance);
    world.scratch.self_crossing_places.resize(model.bodies.slot.size());
    // Nodes that are only drawn (those of round bodies) can be updated late, unless there are force elements: these
    // read all nodes in every step.
    world.scratch.parameters.draws_late = !model.forced;
    // `stiffened`: energy that clusters (groups of nodes that implicit elements couple) have gained by stiffening since
    // the last committed step [J]. `stiffened_before`: its value before the attempt that computed the present forces.
    // If these are discarded, `stiffened` returns to this value.
    Real stiffened = 0, stiffened_before = 0;
    // With leapfrog, the balance is checked only at the end of the call, when positions and velocities belong to one
    // time.
    bool check_at_end = false;
    // With ranks, each rank sums the values of its own bodies, and join_records adds the sums of all ranks.
    Balance& balance = world.ranks.on() ? world.ranks.share.balance : world.record.balance;
    bool& stops = world.ranks.stops;  // true if a callback has asked to end the call
    stops = world.ranks.all_findings.stop = false;
    world.transaction.begin_call(model, clock);
    ForceLedger& forces = world.record.forces;
    const Real step_before = clock.step_before;
    if (forces.on()) forces.begin_call(model, step_before, world.scratch);
    const auto drift = [&](Real offset) {
        const Real seconds = offset - clock.offset;
        drift_to(*world.executor, offset, model, clock, search);
        if (forces.on() && seconds != 0) forces.add_drift(model, seconds, world.scratch);
    };
    while (remaining > 0) {
        if (go_on && !stops && !callbacks.run([&] { return go_on(std::as_const(report)); })) stops = true;
        // With ranks, the stages of each step tell all ranks whether a callback of any rank has asked to stop
        // (all_findings.stop). So all ranks end the call after the same step.
        if (world.ranks.on() ? world.ranks.all_findings.stop : stops) {
            report.status = StepStatus::stopped;
            break;
        }
        if (model.force_rate_moves) note_force_rates(model);
        if (model.of_ranks.moves) reduce_limits(world);
        if (is_too_stiff(world, attempt, end)) {
            blame(world, report);
            break;
        }
        // A repeated attempt with longer contact lists or with crossings must keep the step length for which these were
        // found.
        if (attempt.with_longer_lists == 0 && attempt.with_crossings == 0) limit_turns(world, attempt);
        const Real time_to_interval_end = time_to_end_of_long_step(model, remaining, clock.long_step);
        const StepPlan plan = plan_step(model, time_to_interval_end, attempt.at_most());
        if (model.watch.first_piece.empty()) count_pieces(world);
        store_shapes(*world.executor, model, steps_per_round(world));
        world.query_trees.forget();
        if (leapfrog) drift(plan.h / 2);
        const Real start = clock.time;
        const std::uint64_t let_through = world.cache.crossings.let_through;
        const StepOutcome outcome = try_step(world, plan, attempt);
        if (!world.scratch.parameters.forces_known) stiffened_before = stiffened;
        // This energy counts even if the attempt is not committed, because cluster matrices keep the update that has
        // caused it.
        stiffened += world.scratch.findings.stiffened;
        note_outcome(outcome, world.record.counters, report);
        if (outcome == StepOutcome::again_over_ranks && fetch_ghosts(world)) stiffened = stiffened_before;
        if (outcome == StepOutcome::refused) {
            blame(world, report);
            break;
        }
        if (outcome != StepOutcome::committed) continue;
        complete_step(world, let_through, report);
        remaining = plan.steps > 1 || time_to_interval_end < remaining ? remaining - plan.h : 0;
        move_on_in_long_step(plan, clock.long_step);
        balance.work += std::exchange(stiffened, Real(0));
        if (keep_watch(world) && !check_after_rounds(world)) check_at_end = true;
        const bool callbacks_ok = callbacks.run([&] {
            show_contact_problem(world, start);
            if (world.record.step_watch) world.record.step_watch(std::as_const(report));
            return true;
        });
        stops |= !callbacks_ok;
        if (!callbacks_ok && !world.ranks.on()) break;
    }
    // If a rank has asked to stop in the last step of the call, the loop has ended before its check of
    // all_findings.stop.
    if (!(remaining > 0) && world.ranks.all_findings.stop) report.status = StepStatus::stopped;
    clock.long_step = {};                // no long step continues in the next call
    world.cache.search.end_step(false);  // only has an effect if the last attempt was not committed
    if (report.steps == 0) {
        world.transaction.roll_back_call(model, clock);
        if (leapfrog) measure_displacement_again(*world.executor, model, search);
        if (forces.on()) forces.begin_call(model, step_before, world.scratch);
    } else {
        drift(0);
        world.query_trees.forget();  // a query during the steps may have fitted the trees to other positions
        note_held(held_in_surfaces(world), world, report);
        // Updates stiffened clusters now, because the energy of this update belongs to the present call. Otherwise the
        // first step of the next call would count it.
        stiffened += follow_stiffening(model);
        balance.work += stiffened;
    }
    join_reports(world, report);
    world.draw();
    world.query_trees.forget();
    if (remaining == 0) clock.time = end;
    if (check_at_end) check_balance_after_motion(world);
    return report;
}

}  // namespace

Real lag_between_steps(const WorldState& world) {
    // With leapfrog, the drift at the end of a call brings positions and velocities to the same time.
    if (world.model.settings.integrator == Integrator::leapfrog) return 0;
    const Real before = world.clock.step_before;
    const Real step = before > 0 ? before : longest_allowed_step(world.model);
    return std::isfinite(step) ? step / 2 : 0;  // infinite in a world without bodies, where the lag has no meaning
}

StepReport World::advance(Real dt) {
    return advance(dt, {});
}

StepReport World::advance(Real dt, const std::function<bool(const StepReport&)>& go_on) {
    WorldState& world = *state_;
    world.require_between_steps("advance");
    if (!(dt >= 0) || !std::isfinite(dt)) refuse("advance", "dt", short_text(dt), "a time >= 0 (s)");
    // Sets the floating-point mode, so that the code between the stages does not depend on the mode of the caller.
    const ArithmeticScope arithmetic;
    settle_start();
    const AdvanceScope scope(world.advancing);
    Callbacks callbacks;
    StepReport report;
    act_together(world.ranks.ranks, [&] { report = take_steps(world, dt, go_on, callbacks); });
    callbacks.rethrow();
    return report;
}

void World::watch_steps(std::function<void(const StepReport&)> observe) {
    state_->require_between_steps("watch_steps");
    state_->record.step_watch = std::move(observe);
}

}  // namespace skerry
