// The loop that fills a span of time with steps, and what it does when one cannot be taken.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "engine/world/world_state.h"
#include "jobs/arithmetic_scope.h"

namespace skerry {

namespace {

/// Steps between two looks at the stable step: it changes with deformation, over many steps.
/// In cycles of fine steps it is the coarse ones that count: all elements deform at the pace of the whole.
constexpr std::uint64_t steps_per_watch = 256;

/// A step that a body is too fast for, or in which something crosses, is tried again at half its length, down to this fraction of the stable
/// step; then steps grow back. The bound is on the length: halvings counted step by step add up until time stands still.
constexpr Real most_shortening = 64;
constexpr Real step_growth = 1.1;

/// Tries at one length of step with the crossings of the last ones as contacts, before the step is shortened.
constexpr int tries_at_one_length = 4;

/// The same for a step that turns elements inside out: where they are pressed over, and not thrown, shorter steps are in vain.
constexpr Real most_shortening_against_inversion = 4;

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
        case StepFault::none:
            break;
    }
    return StepStatus::ok;
}

void blame(const WorldState& world, StepReport& report) {
    const StepVerdict& verdict = world.step.verdict;
    report.status = status_of(verdict.fault);
    report.value = verdict.value;
    if (verdict.body == no_index) return;
    const auto b = static_cast<std::size_t>(verdict.body);
    if (world.bodies.kind[b] == BodyKind::deformable) report.body = world.body_map.handle_of_slot(world.bodies.slot[b]);
    report.body_name = world.body_records[b].name;
    if (verdict.node != no_index) report.node = verdict.node - world.bodies.nodes[b].begin;
    if (verdict.element != no_index) report.element = user_element(world, b, verdict.element);
}

void add_to_report(const WorldState& world, StepReport& report) {
    const RegionTable& regions = world.regions;
    report.contacts = static_cast<Index>(world.contacts.size());
    report.regions = static_cast<Index>(regions.size());
    report.largest_region = 0;
    for (std::size_t r = 0; r < regions.size(); ++r) {
        report.largest_region = std::max(report.largest_region, regions.contacts.offset[r + 1] - regions.contacts.offset[r]);
        report.unconverged += regions.status[r] == RegionStatus::iteration_limit;
        if (!(regions.error[r] > report.worst_error)) continue;
        report.worst_error = regions.error[r];
        report.worst_region = regions.contacts.offset[r + 1] - regions.contacts.offset[r];
    }
    report.max_penetration = std::max(report.max_penetration, world.step.measures.max_penetration);
    report.max_gap_violation = std::max(report.max_gap_violation, world.step.measures.max_gap_violation);
    ++report.steps;
}

void note_inversions(WorldState& world, StepReport& report) {
    const Inversions& inversions = world.step.inversions;
    if (inversions.count == 0) return;
    const auto b = static_cast<std::size_t>(inversions.body);
    if (report.inverted == 0) {
        report.inverted_body = world.body_map.handle_of_slot(world.bodies.slot[b]);
        report.inverted_name = world.body_records[b].name;
        report.inverted_element = user_element(world, b, inversions.element);
    }
    report.inverted += inversions.count;
    world.counters.inversions += static_cast<std::uint64_t>(inversions.count);
}

/// Says that the step asked for was too long for a body.
void note_limit(WorldState& world, StepReport& report) {
    Index body = no_index;
    const Real trusted = trusted_step(world, &body);
    if (!world.settings.step_size || body == no_index || *world.settings.step_size <= trusted) return;
    ++report.limited;
    ++world.counters.limited;
    report.limited_step = trusted;
    report.limited_by = world.body_records[static_cast<std::size_t>(body)].name;
}

/// Steps are counted with an int; a step so small that time does not move on by it would go on for ever.
void require_countable(Real dt, Real step) {
    constexpr Real most = std::numeric_limits<int>::max();
    if (!(dt > most * step)) return;
    char found[64];
    std::snprintf(found, sizeof found, "%g s in steps of %g s", dt, step);
    Complaint{.file = {}, .object = "advance", .field = "dt", .found = found, .expected = "at most 2147483647 steps", .hint = {}}.raise();
}

/// A step that crosses at any length is taken nevertheless, and reported: the push out of overlaps has to mend it.
void take_crossing_step(WorldState& world, Real h, StepReport& report) {
    const std::uint64_t before = world.crossings.let_through;
    world.crossings.last_try = world.step.let_invert = true;
    take_step(world, h);
    world.crossings.last_try = false;
    report.crossed += static_cast<Index>(world.crossings.let_through - before);
}

}  // namespace

StepReport World::advance(Real dt) {
    if (!(dt >= 0) || !std::isfinite(dt))
        Complaint{.file = {}, .object = "advance", .field = "dt", .found = std::to_string(dt), .expected = "a time >= 0 (s)", .hint = {}}
            .raise();
    const ArithmeticScope arithmetic;  // what is done between the stages depends on the host no more than they do
    WorldState& world = *state_;
    require_countable(dt, world.settings.step_size.value_or(skerry::stable_step(world) * world.settings.step_safety));
    StepReport report;
    const Real end = world.step.time + dt;
    Real left = dt;
    world.crossings.row.clear();                              // of a step that was given up: bodies may have changed since
    Real fast_limit = std::numeric_limits<Real>::infinity();  // s, while a body moves too fast for longer steps
    if (world.counters.steps == 0 && left > 0) check_balance(world);
    bool look_at_end = false;  // energies are those of one time only between calls of leapfrog
    keep_start(world);
    int tries = 0;  // of this step, because something crossed
    while (left > 0) {
        Index stiffest = no_index;
        const Real trusted = trusted_step(world, &stiffest);
        if (!(std::min(trusted, fast_limit) > std::numeric_limits<Real>::epsilon() * end)) {
            world.step.verdict = {StepFault::too_stiff, stiffest, no_index, trusted};
            blame(world, report);
            break;
        }
        const StepPlan plan = plan_step(world, left, fast_limit);
        if (world.settings.integrator == Integrator::leapfrog) drift_to(world, plan.h / 2);
        const Real start = world.step.time;
        world.step.let_invert = !(plan.h > plan.stable / most_shortening_against_inversion);
        take_step(world, plan.h);
        if (world.step.crossings > 0 && ++tries < tries_at_one_length) {
            ++report.retried;
            ++world.counters.retried;
            continue;
        }
        tries = 0;
        const bool too_fast = world.step.verdict.fault == StepFault::too_fast;
        if ((too_fast || world.step.crossings > 0) && plan.h > plan.stable / most_shortening) {
            world.crossings.row.clear();
            fast_limit = plan.h / 2;
            ++report.shortened;
            ++world.counters.shortened;
            continue;
        }
        if (world.step.verdict.fault == StepFault::none && world.step.crossings == 0 && world.step.inverts()) {
            fast_limit = plan.h / 2;
            ++report.shortened;
            ++world.counters.shortened;
            continue;
        }
        if (world.step.crossings > 0) take_crossing_step(world, plan.h, report);
        if (world.step.verdict.fault != StepFault::none) {
            blame(world, report);
            break;
        }
        fast_limit *= step_growth;
        report.step_size = plan.h;
        add_to_report(world, report);
        note_inversions(world, report);
        note_limit(world, report);
        left = plan.steps > 1 ? left - plan.h : 0;
        // Between cycles: within one, levels must stay.
        if (++world.steps_since_watch >= steps_per_watch << world.step.cycle.levels && world.step.cycle.index == 0) {
            world.steps_since_watch = 0;
            watch_stable_step(world);
            if (world.step.offset == 0)
                check_balance(world);
            else
                look_at_end = true;
        }
        show_contact_problem(world, start);
    }
    if (report.steps == 0)
        put_back_start(world);
    else
        drift_to(world, 0);
    if (left == 0) world.step.time = end;
    if (look_at_end) check_balance(world);
    return report;
}

}  // namespace skerry
