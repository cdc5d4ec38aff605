// One step, all or nothing, and the loop that fills a span of time with steps.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "engine/world/world_state.h"
#include "jobs/arithmetic_scope.h"
#include "systems/dynamics/keep_frames.h"
#include "systems/dynamics/stable_step.h"

namespace skerry {

namespace {

/// Below this many elements and contacts together a step takes less time than waking the workers costs (profiling/step measures it).
constexpr std::size_t inline_work = 1024;

/// Steps between two looks at the stable step: it changes with deformation, over many steps.
/// In cycles of fine steps it is the coarse ones that count: all elements deform at the pace of the whole.
constexpr std::uint64_t steps_per_watch = 256;

/// A step that a body is too fast for, or in which something crosses, is tried again at half its length, down to this fraction of the stable
/// step; then steps grow back. The bound is on the length: halvings counted step by step add up until time stands still.
constexpr Real most_shortening = 64;
constexpr Real step_growth = 1.1;

/// Tries at one length of step with the crossings of the last ones as contacts, before the step is shortened.
constexpr int tries_at_one_length = 4;

/// What a step overwrites that is not its result, so that a step that is not committed leaves it as it was.
void keep_for_refusal(WorldState& world) {
    world.speed_before.resize(world.bodies.max_speed.size());
    std::copy(world.bodies.max_speed.begin(), world.bodies.max_speed.end(), world.speed_before.begin());
    world.velocity_before_drive.resize(world.attachments.node.size());
    for (std::size_t i = 0; i < world.attachments.node.size(); ++i)
        world.velocity_before_drive[i] = world.nodes.velocity[static_cast<std::size_t>(world.attachments.node[i])];
}

void put_back(WorldState& world) {
    std::copy(world.speed_before.begin(), world.speed_before.end(), world.bodies.max_speed.begin());
    for (std::size_t i = 0; i < world.attachments.node.size(); ++i)
        world.nodes.velocity[static_cast<std::size_t>(world.attachments.node[i])] = world.velocity_before_drive[i];
}

/// A contact may have given bodies at rest a velocity that was not committed.
void keep_at_rest(WorldState& world) {
    if (!world.any_asleep) return;
    for (std::size_t b = 0; b < world.bodies.asleep.size(); ++b) {
        const Range nodes = world.bodies.nodes[b];
        if (world.bodies.asleep[b])
            std::fill(world.nodes.velocity_next.begin() + nodes.begin, world.nodes.velocity_next.begin() + nodes.end, Vec3::Zero());
    }
}

void count_shortcuts(const RegionTable& regions, std::size_t r, RunCounters& counters) {
    const RegionShortcut shortcut = regions.shortcut[r];
    counters.closed_form += (shortcut & shortcut_closed_form) != 0;
    counters.certified += (shortcut & shortcut_certified) != 0;
    counters.separating += (shortcut & shortcut_separating) != 0;
    counters.frictionless += (shortcut & shortcut_frictionless) != 0;
    counters.in_lanes += (shortcut & shortcut_in_lanes) != 0;
    counters.frozen += static_cast<std::uint64_t>(regions.frozen[r]);
    if ((shortcut & (shortcut_closed_form | shortcut_certified | shortcut_separating)) != 0) return;
    ++counters.swept;
    const Index size = regions.contacts.offset[r + 1] - regions.contacts.offset[r];
    counters.contact_steps += static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(regions.iterations[r]);
}

void count(WorldState& world) {
    RunCounters& counters = world.counters;
    const RegionTable& regions = world.regions;
    const auto contact_count = static_cast<Index>(world.contacts.size());
    const auto region_count = static_cast<Index>(regions.size());
    ++counters.steps;
    counters.contacts += static_cast<std::uint64_t>(contact_count);
    counters.regions += static_cast<std::uint64_t>(region_count);
    counters.max_contacts = std::max(counters.max_contacts, contact_count);
    counters.max_regions = std::max(counters.max_regions, region_count);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const Index size = regions.contacts.offset[r + 1] - regions.contacts.offset[r];
        counters.largest_region = std::max(counters.largest_region, size);
        counters.iterations += static_cast<std::uint64_t>(regions.iterations[r]);
        count_shortcuts(regions, r, counters);
        counters.unconverged += regions.status[r] == RegionStatus::iteration_limit;
        if (!(regions.error[r] > counters.worst_error)) continue;
        counters.worst_error = regions.error[r];
        counters.worst_region = size;
    }
    counters.dissipated += world.step.measures.dissipated + world.step.damped + world.step.rest.energy;
    counters.max_penetration = std::max(counters.max_penetration, world.step.measures.max_penetration);
    counters.max_gap_violation = std::max(counters.max_gap_violation, world.step.measures.max_gap_violation);
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

}  // namespace

void add_collider_travel(WorldState& world, Real seconds) {
    for (std::size_t c = 0; c < world.colliders.slot.size(); ++c) {
        const RigidMotion& motion = world.colliders.motion[c];
        // A turning shape moves its far points fastest; what is near a body is within the extent that the search has noted.
        const Real turning = motion.angular_velocity.norm();
        const Column<Real>& extent = world.search.memory.collider_extent;
        const Real rim_speed = turning > 0 && c < extent.size() ? turning * extent[c] : 0;
        world.colliders.travel[c] += seconds * (motion.velocity.norm() + rim_speed);
    }
}

Real stable_step(const WorldState& world, Index* body) {
    Real smallest = std::numeric_limits<Real>::infinity();
    for (std::size_t b = 0; b < world.bodies.slot.size(); ++b)
        if (world.bodies.stable_step[b] < smallest) {
            smallest = world.bodies.stable_step[b];
            if (body) *body = static_cast<Index>(b);
        }
    return smallest;
}

Real trusted_step(const WorldState& world, Index* body) {
    const Real stable = stable_step(world, body) * world.settings.step_safety;
    return std::min(stable, world.settings.step_size.value_or(stable));
}

void watch_stable_step(WorldState& world) {
    for (std::size_t b = 0; b < world.bodies.slot.size(); ++b)
        if (world.bodies.element_count[b] > 0)
            world.bodies.stable_step[b] =
                stable_step(world.element_inputs(), world.bodies.blocks[b], world.nodes.position, world.nodes.mass, world.stiffness_sum)
                    .step;
}

void take_step(WorldState& world, Real h) {
    world.step.h = h;
    world.step.measures = {};
    world.step.damped = 0;
    world.step.external = {};
    world.step.rest = {};
    world.step.crossings = 0;
    world.step.verdict = check_distance(world.nodes.position, world.bodies.nodes, world.bodies.mean_edge);
    if (world.step.verdict.fault != StepFault::none) return;
    world.note_rest();
    world.step.verdict = check_distance(world.nodes.position, world.bodies.nodes, world.bodies.mean_edge);
    if (world.step.verdict.fault != StepFault::none) return;
    find_due_levels(world);
    keep_for_refusal(world);
    Trace* const trace = world.tracing ? &world.trace : nullptr;
    const bool small = world.elements.node.size() * element_lanes + world.contacts.size() < inline_work;
    if (small)
        world.graph.run_inline(trace);
    else
        world.graph.run(*world.executor, trace);
    world.contact_view_is_current = false;
    if (!world.step.taken()) {
        put_back(world);
        keep_at_rest(world);
        if (world.step.verdict.fault == StepFault::not_finite) {
            for (Real& speed : world.bodies.max_speed) speed = 0;  // of this step; the search measures afresh
            world.search_afresh();
        }
        return;
    }
    world.crossings.row.clear();
    ElementBlockTable& elements = world.elements;
    if (world.step.due.all() && !world.any_asleep)
        elements.rotation.swap(elements.rotation_next);
    else
        keep_frames(*world.executor, world.element_inputs(), elements.rotation_next, elements.rotation);
    add_collider_travel(world, h);
    count(world);
    add_step(world);
    count_impulses(world);
    world.counters.inline_steps += small;
    world.step.time += h;
}

namespace {

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
    world.crossings.last_try = true;
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
        if (world.step.crossings > 0) take_crossing_step(world, plan.h, report);
        if (world.step.verdict.fault != StepFault::none) {
            blame(world, report);
            break;
        }
        fast_limit *= step_growth;
        report.step_size = plan.h;
        add_to_report(world, report);
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
