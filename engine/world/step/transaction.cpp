#include "engine/world/step/transaction.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/world/step/step.h"
#include "systems/dynamics/elements/keep_memory.h"

namespace skerry {

namespace {

/// Number of elements plus contacts below which all stages run on the calling thread. To wake the worker threads would
/// take longer than such a small step (measured by profiling/step).
constexpr std::size_t inline_work = 1024;

/// Largest number of attempts with the same step length if surfaces cross. Crossings found in an attempt become
/// contacts of the following attempts. If surfaces cross in the last of these attempts too, the step is shortened.
constexpr int tries_at_one_length = 4;

/// A step in which surfaces cross is halved if it is longer than StepPlan::regular divided by this factor. In the next
/// steps the length grows again (step_growth). Step lengths predicted from the speed of deformation have the same lower
/// limit.
///
/// A limit for the halvings in one step would not suffice: a few in each of many steps would add up.
constexpr Real most_shortening = 128;

/// A step that deforms an element too fast, or for which Newton's method fails, is shortened if it is longer than
/// StepPlan::regular divided by this factor. The factor must be large: material squeezed out between a rigid body and
/// held nodes moves several hundred times as fast as the rigid body.
constexpr Real most_shortening_against_speed = 1024;

/// A step that turns elements inside out is halved if it is longer than StepPlan::regular divided by this factor.
/// Otherwise the inversion is accepted.
///
/// In thrown meshes, halving prevents a third of the inversions. In squeezed meshes it prevents none, but crushed
/// bodies gain less energy. With the factor 2, or with a larger step_growth, a ball shot at a wall gains a third more
/// energy.
constexpr Real most_shortening_against_inversion = 4;

/// Factor by which AttemptLimits::longest grows in each committed step.
constexpr Real step_growth = 1.2;

/// Upper limit of the ratio of a step length to the previous one, while the speed of deformation limits the steps.
constexpr Real fast_growth = 1.5;

/// Fraction of the largest allowed change of strain for which the next step is planned. It is below 1 because the next
/// step may deform elements faster than the present one.
constexpr Real strain_margin = 0.9;
/// Limits of the length of a repeated step, as fractions of the attempt that deformed an element too fast.
/// longest_repeat is the upper limit, so that each repetition shortens the step. shortest_repeat is the lower limit.
constexpr Real longest_repeat = 0.9, shortest_repeat = 0.25;

void copy(std::span<const Real> from, Column<Real>& to) {
    to.resize(from.size());
    std::ranges::copy(from, to.begin());
}

/// Sets velocity_next of sleeping bodies to zero. Contacts may have changed it in an attempt that is not committed.
void keep_at_rest(const BodyTable& bodies, std::span<Vec3> velocity_next) {
    for (std::size_t b = 0; b < bodies.asleep.size(); ++b) {
        const Range nodes = bodies.nodes[b];
        if (bodies.asleep[b])
            std::fill(velocity_next.begin() + nodes.begin, velocity_next.begin() + nodes.end, Vec3::Zero());
    }
}

/// Returns the kick of a step: the time for which forces act on velocities [s]. With leapfrog it is the length of the
/// step. With symplectic Euler it lasts from the middle of the last step to the middle of this step
/// (docs/methods/time_stepping.md 1.5).
Real kick_of_step(const Model& model, const Clock& clock, const StepPlan& plan) {
    if (model.settings.integrator != Integrator::symplectic_euler || clock.step_before == 0) return plan.h;
    Real before = clock.step_before;
    // The last step counts with at most `growth` times the present stable step. If it was longer, a body was added or
    // has become stiffer since, and the kick would be too long for this body.
    constexpr Real growth = 2;
    if (before > growth * plan.stable)
        before = std::min(before, growth * model.tuning.step_safety * stable_step(model));
    return (before + plan.h) / 2;
}

/// Runs the stages of an attempt, unless nothing moves. The stages write their results to world.scratch. Returns false
/// if the attempt fails before the stages, because a body is too far from the origin.
bool run_stages(WorldState& world) {
    StepScratch& scratch = world.scratch;
    Model& model = world.model;
    const StepFindings before = std::exchange(scratch.findings, {});
    if (scratch.parameters.forces_known) {
        scratch.findings.relaxed = before.relaxed;
        scratch.findings.unstrained = before.unstrained;
    }
    scratch.awake_mass = model.note_rest();
    scratch.skipped = nothing_moves(world);
    if (!scratch.skipped || world.ranks.on())
        scratch.findings.verdict =
            check_distance(*world.executor, model.nodes.position, model.bodies.nodes, model.bodies.mean_edge);
    agree_to_start(world);
    if (scratch.findings.verdict.fault != StepFault::none) return false;
    scratch.pressed.clear();
    const bool drivable =
        scratch.parameters.sleep.on() && (model.forced || model.joints.size() > 0 || model.ties.size() > 0);
    scratch.driven.assign(drivable ? model.bodies.slot.size() : 0, 0);
    world.transaction.begin_try(model);
    if (world.ranks.on() && !scratch.parameters.forces_known) world.transaction.keep_stiffness(model);
    world.record.contact_view_is_current = false;
    if (scratch.skipped) {
        scratch.ran_inline = false;
        if (scratch.parameters.forces_wanted) forget_forces_of_step(model, scratch.forces);
        return true;
    }
    world.record.balance_of_rest = false;
    Trace* const trace = world.record.tracing ? &world.record.trace : nullptr;
    const bool small = model.elements.first.size() * element_lanes + scratch.contacts.size() < inline_work;
    if (small)
        world.graph.run_inline(trace);
    else
        world.graph.run(*world.executor, trace);
    scratch.ran_inline = small;
    StepVerdict& verdict = scratch.findings.verdict;
    if (verdict.fault == StepFault::not_finite && scratch.findings.strained.unsolved != no_index)
        verdict = {StepFault::unsolved, scratch.findings.strained.unsolved};
    return true;
}

/// Makes the element rotations and spring strains that this step has computed the input of the next step. If no body
/// sleeps, whole columns are swapped, which is faster than copying rows.
void keep_frames(WorldState& world) {
    ElementBlockTable& elements = world.model.elements;
    if (!world.model.any_asleep) {
        // Rows that the step has not computed are swapped too. For unstrained bodies both columns have equal values,
        // and rows of led ghosts (copies of bodies on which another rank computes the forces) are never read.
        elements.rotation.swap(elements.rotation_next);
        elements.spring_strain.swap(elements.spring_strain_next);
        return;
    }
    // Copies only the rows that the stages of this step have computed. awake_elements() still returns these rows,
    // although bodies may have fallen asleep or woken in this step: the result of this function changes only when the
    // next step begins.
    keep_memory(*world.executor, world.model.awake_elements(), elements);
}

/// Plastic flow at the end of a step, of the elements of all bodies that the step computed (yield_blocks).
void flow(WorldState& world) {
    const bool yields = std::ranges::any_of(world.model.materials.constants, &MaterialConstants::yields);
    const TraceZone zone(world.record.tracing && yields ? &world.record.trace : nullptr, "dynamics/yield_elements");
    world.scratch.findings.plastic = yield_blocks(world, world.model.awake_elements(), world.model.all_blocks());
}

/// Clears the mark `unstrained` of all bodies in contact, so that their elements are computed again. Must be called
/// after a step in which contacts pushed bodies out of overlaps (RegionTable::pushed). Such a push changes no
/// velocities, which are all that find_unstrained compares in most steps.
void forget_unstrained(const ContactTable& contacts, BodyTable& bodies) {
    for (const Column<Index>* column : {&contacts.first_body, &contacts.second_body})
        for (const Index body : *column)
            if (body != no_index) bodies.unstrained[body] = 0;
}

RunCounters counters_of_step(const WorldState& world) {
    const StepScratch& scratch = world.scratch;
    const StepFindings& found = scratch.findings;
    RunCounters counters =
        world.ranks.on() && !scratch.skipped
            ? world.ranks.all_findings.counters
            : count_step(scratch.contacts, scratch.regions, found.measures, found.strained.newton, found.unstrained);
    counters.inline_steps = scratch.ran_inline;
    counters.resting_steps = scratch.skipped;
    return counters;
}

void commit(WorldState& world) {
    StepScratch& scratch = world.scratch;
    const StepParameters& parameters = scratch.parameters;
    world.cache.crossings.row.clear();
    world.cache.search.end_step(true);
    if (world.record.forces.on()) world.record.forces.add_step(world.model, world.transaction.asleep_before(), scratch);
    if (!scratch.skipped) {
        keep_frames(world);
        flow(world);
        if (world.ranks.on() ? world.ranks.all_findings.pushed : scratch.regions.pushed) {
            forget_unstrained(scratch.contacts, world.model.bodies);
            for (const Index body : scratch.rank_regions.touched_bodies) world.model.bodies.unstrained[body] = 0;
        }
        add_collider_travel(parameters.h, world.cache.search.memory.collider_extent, world.model.colliders);
    }
    scratch.counters = counters_of_step(world);
    count_committed_step(scratch.counters, world.record.counters);
    RankShare& share = world.ranks.share;
    const bool divided = world.ranks.on();
    share.balance.open = world.record.balance.open;
    (divided ? share.dissipated : world.record.counters.dissipated) += dissipated_in(scratch.findings);
    (divided ? share.plastic_work : world.record.counters.plastic_work) += scratch.findings.plastic;
    add_step(scratch, divided ? share.balance : world.record.balance);
    world.clock.time += parameters.h;
    world.clock.step_before = parameters.h;
}

/// Counts a committed step under the cause that limited its length: earlier attempts, fast deformation, rotation at
/// joints, the settings or the stiffest body.
void note_step(WorldState& world, const StepPlan& plan, const AttemptLimits& attempt) {
    const Model& model = world.model;
    const bool fast = attempt.slow_enough < attempt.longest;
    StepLimit limit = fast ? StepLimit::speed : attempt.limit;
    Index body = fast ? attempt.fastest : attempt.body;
    if (!(attempt.at_most() < plan.stable)) {
        const bool here = plan.stiffest != no_index;
        const auto b = static_cast<std::size_t>(plan.stiffest);
        body = world_row_of_stiffest(world, plan.stiffest);
        const Real stable = here ? step_of_body(model, b) : model.of_ranks.stable_step;
        const bool set = body == no_index || plan.stable < stable * model.tuning.step_safety;
        const bool strained = here ? is_strained(model, b) : model.of_ranks.strained;
        limit = set ? StepLimit::setting : (strained ? StepLimit::strain : StepLimit::rest);
        if (set) body = no_index;
    }
    const auto [handle, name] = name_body(world, body);
    world.record.limits.count_step(limit, handle, name, plan.h);
}

/// Returns the reason why an attempt is given up for a shorter step.
StepLimit shortened_by(const StepFindings& found) {
    return found.crossings > 0                          ? StepLimit::crossing
           : found.verdict.fault == StepFault::too_fast ? StepLimit::speed
           : found.verdict.fault == StepFault::unsolved ? StepLimit::strain
                                                        : StepLimit::inversion;
}

/// Limits of the next attempt, after an attempt that is given up for a shorter step. If the deformation was too fast,
/// the rate of deformation determines the new length. For all other causes the length is halved.
AttemptLimits limits_of_shorter_attempt(const WorldState& world, const StepPlan& plan, const AttemptLimits& attempt) {
    const StepFindings& found = world.scratch.findings;
    const StrainRate& fastest = found.verdict.fastest;
    AttemptLimits next{.longest = attempt.longest,
                       .slow_enough = attempt.slow_enough,
                       .fastest = attempt.fastest,
                       .limit = attempt.limit,
                       .body = attempt.body};
    if (found.crossings == 0 && found.verdict.fault == StepFault::too_fast) {
        const Real least = plan.h > plan.regular / most_shortening
                               ? plan.regular
                               : plan.regular * most_shortening / most_shortening_against_speed;
        const Real slow = slow_enough(fastest, world.scratch.parameters.max_strain_step, least);
        next.slow_enough = std::clamp(slow, plan.h * shortest_repeat, plan.h * longest_repeat);
        next.fastest = fastest.body;
    } else {
        next.longest = plan.h / 2;
        next.limit = shortened_by(found);
        next.body = next.limit == StepLimit::strain      ? found.verdict.body
                    : next.limit == StepLimit::inversion ? found.inversions.body
                                                         : no_index;
    }
    return next;
}

/// Limits of the first attempt at the next step, after a committed step. The fastest deformation limits the length.
/// After a step that was shortened because of fast deformation, the length grows by at most the factor fast_growth.
AttemptLimits limits_of_next_attempt(const StepScratch& scratch, const StepPlan& plan, const AttemptLimits& attempt) {
    const StrainRate& fastest = scratch.findings.verdict.fastest;
    AttemptLimits next{.longest = attempt.longest * step_growth,
                       .slow_enough = slow_enough(fastest, scratch.parameters.max_strain_step, plan.regular),
                       .fastest = fastest.body,
                       .limit = attempt.limit,
                       .body = attempt.body};
    if (fastest.body == no_index && scratch.parameters.longest < plan.stable && attempt.slow_enough < attempt.longest) {
        // The check found no deformation that is too fast for a step of length StepParameters::longest. Longer steps
        // were not checked, so the length grows only by fast_growth.
        next.slow_enough = fast_growth * plan.h;
        next.fastest = attempt.fastest;
    }
    return next;
}

/// Adds an attempt that was given up for a shorter one to the counts of WorldReport. The attempt is counted under its
/// cause (shortened_by) and the body that caused it.
void note_try(WorldState& world) {
    const StepFindings& found = world.scratch.findings;
    const StepLimit limit = shortened_by(found);
    const Index body = limit == StepLimit::crossing    ? no_index
                       : limit == StepLimit::inversion ? found.inversions.body
                                                       : found.verdict.body;
    const auto [handle, name] = name_body(world, body);
    world.record.limits.count_try(limit, handle, name);
}

/// Returns the outcome of an attempt, according to the table at StepOutcome. `again_over_ranks`: the ranks must repeat
/// the attempt. `beyond_lists`: features may cross that were not in the contact lists.
StepOutcome judge(const StepScratch& scratch, bool again_over_ranks, bool beyond_lists, const StepPlan& plan,
                  AttemptLimits& attempt) {
    const StepFindings& found = scratch.findings;
    if (again_over_ranks) return StepOutcome::again_over_ranks;
    if (beyond_lists) {
        ++attempt.with_longer_lists;
        return StepOutcome::again_with_longer_lists;
    }
    const bool crosses = found.crossings > 0;
    if (scratch.taken()) return StepOutcome::committed;
    if (crosses && ++attempt.with_crossings < tries_at_one_length) return StepOutcome::again_with_crossings;
    if (crosses || found.verdict.fault == StepFault::too_fast || found.verdict.fault == StepFault::unsolved) {
        if (plan.h > plan.regular / (crosses ? most_shortening : most_shortening_against_speed))
            return StepOutcome::again_shorter;
        return crosses ? StepOutcome::again_letting_through : StepOutcome::refused;
    }
    return found.verdict.fault == StepFault::none ? StepOutcome::again_shorter : StepOutcome::refused;
}

}  // namespace

Real slow_enough(const StrainRate& fastest, Real max_strain_step, Real stable) {
    const Real longest = fastest.rate > 0 ? strain_margin * max_strain_step / fastest.rate : infinity;
    return std::max(longest, stable / most_shortening);
}

StepOutcome try_step(WorldState& world, const StepPlan& plan, AttemptLimits& attempt) {
    StepScratch& scratch = world.scratch;
    const bool tried = attempt.with_longer_lists > 0 || attempt.with_crossings > 0 || attempt.over_ranks;
    scratch.parameters.forces_known = tried && scratch.parameters.h == plan.h;
    scratch.parameters.h = plan.h;
    scratch.parameters.longest = std::min(plan.stable, plan.h * fast_growth / strain_margin);
    scratch.parameters.kick_time = kick_of_step(world.model, world.clock, plan);
    scratch.parameters.lag = scratch.parameters.kick_time - plan.h / 2;
    const bool leapfrog = world.model.settings.integrator == Integrator::leapfrog;
    scratch.parameters.work_lag = leapfrog ? 0 : scratch.parameters.lag;
    const Real now = world.clock.time;
    scratch.parameters.intervals = {.begin = now - scratch.parameters.lag,
                                    .length = scratch.parameters.kick_time,
                                    .begin_implicit = leapfrog ? now - plan.h / 2 : now,
                                    .length_implicit = plan.h};
    scratch.parameters.let_invert =
        attempt.letting_through || !(plan.h > plan.regular / most_shortening_against_inversion);
    scratch.parameters.long_step = times_in_long_step(world.clock.long_step, plan);
    scratch.parameters.problem_wanted = world.record.problem_watch.wants(world.record.counters.steps + 1);
    scratch.parameters.forces_wanted = world.record.forces.on();
    scratch.parameters.moment_point = world.record.forces.moment_point();
    world.cache.crossings.last_attempt = attempt.letting_through;
    world.cache.crossings.beyond_lists = false;
    world.cache.crossings.found_count = 0;
    // Largest number of repetitions of an attempt with longer contact lists. Contacts found in the longer lists change
    // the motion, which may exceed these lists too. After the last repetition, features that come near enough to cross
    // without being in the lists count as crossings.
    constexpr int most_longer_lists = 8;
    world.cache.crossings.extends_lists = attempt.with_longer_lists < most_longer_lists;
    const bool ran = run_stages(world);
    if (world.ranks.on() && ran && !scratch.skipped)
        world.ranks.label_rounds.note(world.ranks.all_findings.label_rounds);
    const StepOutcome outcome =
        judge(scratch, world.ranks.all_findings.again_over_ranks(), world.cache.crossings.beyond_lists, plan, attempt);
    switch (outcome) {
        case StepOutcome::committed:
            commit(world);
            note_step(world, plan, attempt);
            attempt = limits_of_next_attempt(scratch, plan, attempt);
            return outcome;
        case StepOutcome::again_over_ranks:
            attempt.over_ranks = true;
            break;
        case StepOutcome::again_with_longer_lists:
        case StepOutcome::again_with_crossings:
            break;
        case StepOutcome::again_shorter:
            // The shorter attempt has another motion and finds its crossings anew. The crossings of earlier attempts
            // are therefore cleared. Exception: after an attempt that inverts elements, they remain contacts.
            if (!scratch.inverts()) world.cache.crossings.row.clear();
            note_try(world);
            attempt = limits_of_shorter_attempt(world, plan, attempt);
            break;
        case StepOutcome::again_letting_through:
            attempt.letting_through = true;
            break;
        case StepOutcome::refused:
            break;
    }
    if (ran) world.transaction.roll_back_try(world.model);
    return outcome;
}

void StepTransaction::begin_try(const Model& model) {
    asleep_.resize(model.bodies.asleep.size());
    std::ranges::copy(model.bodies.asleep, asleep_.begin());
    copy(model.bodies.max_speed, max_speed_);
    copy(model.bodies.frame_speed, frame_speed_);
    driven_velocity_.resize(model.attachments.node.size());
    for (std::size_t i = 0; i < driven_velocity_.size(); ++i)
        driven_velocity_[i] = model.nodes.velocity[static_cast<std::size_t>(model.attachments.node[i])];
}

void StepTransaction::roll_back_try(Model& model) const {
    std::ranges::copy(max_speed_, model.bodies.max_speed.begin());
    std::ranges::copy(frame_speed_, model.bodies.frame_speed.begin());
    for (std::size_t i = 0; i < driven_velocity_.size(); ++i)
        model.nodes.velocity[static_cast<std::size_t>(model.attachments.node[i])] = driven_velocity_[i];
    if (model.any_asleep) keep_at_rest(model.bodies, model.nodes.velocity_next);
}

void StepTransaction::keep_stiffness(const Model& model) {
    if (model.clusters.empty()) return;
    modulus_ = model.elements.implicit_modulus;
    inverse_ = model.clusters.inverse;
}

void StepTransaction::restore_stiffness(Model& model) const {
    if (model.clusters.empty()) return;
    model.elements.implicit_modulus = modulus_;
    model.clusters.inverse = inverse_;
}

void StepTransaction::begin_call(const Model& model, const Clock& clock) {
    if (model.settings.integrator != Integrator::leapfrog) return;
    time_ = clock.time;
    position_ = model.nodes.position;
    velocity_ = model.nodes.velocity;
    center_ = model.rigid_bodies.center;
    rotation_ = model.rigid_bodies.rotation;
    moments_ = model.rigid_bodies.moments;
    axes_ = model.rigid_bodies.axes;
    displacement_ = model.implicit_nodes.displacement;
    displacement_velocity_ = model.implicit_nodes.velocity;
    keep_stiffness(model);
}

void StepTransaction::roll_back_call(Model& model, Clock& clock) const {
    if (model.settings.integrator != Integrator::leapfrog) return;
    model.nodes.position = position_;
    model.nodes.velocity = velocity_;
    model.rigid_bodies.center = center_;
    model.rigid_bodies.rotation = rotation_;
    model.rigid_bodies.moments = moments_;
    model.rigid_bodies.axes = axes_;
    model.implicit_nodes.displacement = displacement_;
    model.implicit_nodes.velocity = displacement_velocity_;
    clock.time = time_;
    clock.offset = 0;
    restore_stiffness(model);
}

}  // namespace skerry
