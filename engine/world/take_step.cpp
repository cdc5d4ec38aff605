// One step, all or nothing.
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
    world.step.inversions = {};
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

}  // namespace skerry
