// How long the next step is, and which elements get an impulse in it (multirate, docs/integration.md).
//
// Steps come in cycles of 2^levels. An element of level l gets one impulse in 2^l steps, in the middle of the time that
// it stands for, so that coarse elements are integrated to second order. An impulse is as long as the time that it has
// to cover, and gives equal and opposite parts to the corners at one moment: momentum and angular momentum are kept
// (asynchronous variational integrators: Lew, Marsden, Ortiz, West 2003). Nodes and contacts move on in every step.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/world/step/step.h"
#include "systems/dynamics/elements/touched_elements.h"

namespace skerry {

namespace {

/// For which elements stay touched beside a contact that is no more: what bounces comes back
constexpr std::uint8_t touched_cycles = 8;

/// How many times the own step of a body is halved to the step of the world.
int level_of_body(const Model& model, std::size_t b, Real h) {
    constexpr int most = step_level_count - element_level_count;
    if (model.bodies.blocks[b].size() == 0) return 0;
    const Real ratio = step_of_body(model, b) * model.settings.step_safety / h;
    constexpr Real rounding = 1e-9;
    return ratio > 1 ? static_cast<int>(std::min<Real>(most, std::log2(ratio * (1 + rounding)))) : 0;
}

/// The highest level whose impulses are no longer than elements of the body stand, which deform as fast as they do. The
/// rate may grow until the next look: half of what is allowed is taken.
int cap_of_body(const Model& model, std::size_t b, Real h) {
    const Real ratio = model.bodies.longest_impulse[b] / (2 * h);
    if (!(ratio > 1)) return 0;
    return static_cast<int>(std::min<Real>(step_level_count - 1, std::log2(ratio)));
}

int highest_level(const BodyTable& bodies, std::size_t b) {
    int highest = 0;
    for (int k = 0; k < element_level_count; ++k)
        if (bodies.level_count[b][static_cast<std::size_t>(k)] > 0) highest = bodies.level[b] + k;
    return std::min(highest, static_cast<int>(bodies.level_cap[b]));
}

/// In the next cycle elements beside contacts of this one are due in every step, and those beside contacts that have
/// been no more for some cycles are not.
void note_contacts(Model& model, std::size_t b) {
    BodyTable& bodies = model.bodies;
    const bool due_anyway = highest_level(bodies, b) == 0;
    if (due_anyway ? !bodies.has_touched[b] : !bodies.touched[b] && !bodies.has_touched[b]) return;
    const Range nodes = bodies.nodes[b], blocks = bodies.blocks[b];
    if (due_anyway)
        std::ranges::fill(rows_of(model.elements.touched, blocks), std::uint8_t{0});
    else
        find_touched_blocks(model.element_nodes, model.nodes.touched, blocks, model.elements);
    bodies.has_touched[b] =
        mark_touched(model.elements, model.element_nodes, blocks, nodes, model.patches, model.nodes.levels);
    bodies.touched[b] = 0;
    for (std::uint8_t& left : rows_of(model.nodes.touched, nodes)) {
        left = static_cast<std::uint8_t>(left - (left > 0));
        bodies.touched[b] |= left > 0;
    }
}

/// Counts the elements of a body by the level that they have in this cycle. Returns the highest.
int count_elements(const Model& model, std::size_t b, StepCycle& cycle) {
    const BodyTable& bodies = model.bodies;
    std::array<std::uint64_t, element_level_count> untouched{};
    for (std::size_t k = 0; k < element_level_count; ++k)
        untouched[k] = static_cast<std::uint64_t>(bodies.level_count[b][k]);
    if (bodies.has_touched[b])
        for (auto block = static_cast<std::size_t>(bodies.blocks[b].begin);
             block < static_cast<std::size_t>(bodies.blocks[b].end); ++block) {
            if (!model.elements.touched[block]) continue;
            for (const Real volume : model.elements.volume[block].lane) {
                cycle.elements[0] += volume > 0;
                untouched[model.elements.level[block]] -= volume > 0;
            }
        }
    int top = 0;
    for (int k = 0; k < element_level_count; ++k) {
        const std::uint64_t count = untouched[static_cast<std::size_t>(k)];
        if (count == 0) continue;
        const int level = std::min(bodies.level[b] + k, static_cast<int>(bodies.level_cap[b]));
        cycle.elements[static_cast<std::size_t>(level)] += count;
        top = std::max(top, level);
    }
    return top;
}

/// Whether the impulses of all levels cover the same time.
bool in_step(const StepCycle& cycle, Real h) {
    constexpr Real rounding = 1e-9;
    return std::ranges::all_of(cycle.lead, [&](Real lead) { return std::abs(lead) <= rounding * h; });
}

/// Steps that fill whole cycles.
Real in_whole_cycles(Real steps, int levels) {
    return std::ldexp(std::ceil(std::ldexp(steps, -levels)), levels);
}

/// The length of cycles, all alike, for which a call of at least so many steps costs least.
int cheapest_levels(const StepCycle& cycle, int top, Real steps) {
    int best = 0;
    Real least = std::numeric_limits<Real>::infinity();
    for (int levels = 0; levels <= top; ++levels) {
        Real cost = 0;
        for (int l = 0; l < step_level_count; ++l)
            cost += static_cast<Real>(cycle.elements[static_cast<std::size_t>(l)]) *
                    (element_cost - impulse_cost + std::ldexp(impulse_cost, -std::min(l, levels)));
        cost *= in_whole_cycles(steps, levels);
        if (cost <= least) best = levels;
        least = std::min(least, cost);
    }
    return best;
}

/// Gives bodies their levels for a cycle, and cuts what is left of the call into whole ones.
void begin_cycle(Model& model, StepCycle& cycle, Real left, int& levels_of_call, StepPlan& plan) {
    const Real h = plan.h;
    cycle.index = cycle.levels = 0;
    cycle.h = h;
    // After a cycle that was broken off step by step, until those that are behind have caught up and those that are
    // ahead have waited: which elements are of a level, and which level a body has, may change only then.
    if (!model.settings.multirate || !in_step(cycle, h)) return;
    cycle.elements.fill(0);
    int top = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        model.bodies.level[b] = static_cast<std::uint8_t>(level_of_body(model, b, h));
        model.bodies.level_cap[b] = static_cast<std::uint8_t>(cap_of_body(model, b, h));
        top = std::max(top, count_elements(model, b, cycle));
    }
    top = std::min(top, most_cycle_levels);
    if (levels_of_call < 0) levels_of_call = cheapest_levels(cycle, top, plan.steps);
    cycle.levels = std::min(top, levels_of_call);
    // Shorter cycles for the rest of each call would be in time with some modes (docs/methods/stable_step.md 7.7).
    plan.steps = in_whole_cycles(plan.steps, cycle.levels);
    cycle.h = plan.h = left / plan.steps;
}

}  // namespace

StepPlan plan_step(Model& model, StepCycle& cycle, Real left, Real fast_limit, int& levels_of_call) {
    const bool between = cycle.index == 0;
    StepPlan plan;
    plan.stable = trusted_step(model, &plan.stiffest);
    const Real longest = std::min(between ? plan.stable : cycle.h, fast_limit);
    // A remainder of rounding size joins the last step.
    plan.steps = std::isfinite(longest) ? std::max(1.0, std::ceil(left / longest - 1e-9)) : 1.0;
    plan.h = left / plan.steps;
    if (between) begin_cycle(model, cycle, left, levels_of_call, plan);
    return plan;
}

Real left_in_long_step(const Model& model, Real left, LongStepClock& clock) {
    if (!(model.settings.implicit_step > 0) || model.implicit_nodes.size() == 0) return left;
    if (clock.length == 0) {
        // a remainder of rounding size joins the last one
        const Real count = std::max(1.0, std::ceil(left / model.settings.implicit_step - 1e-9));
        clock.length = clock.left = left / count;
    }
    return clock.left;
}

LongStepTimes times_in_long_step(const LongStepClock& clock, const StepPlan& plan) {
    const LongStepTimes times{clock.length, clock.left == clock.length, plan.steps == 1};
    return times.starts && times.ends ? LongStepTimes{} : times;  // as long as all others
}

void move_on_in_long_step(const StepPlan& plan, LongStepClock& clock) {
    if (plan.steps > 1)
        clock.left -= plan.h;
    else
        clock = {};
}

void find_active_levels(const StepCycle& cycle, BodyTable& bodies, StepParameters& parameters) {
    const Real h = parameters.h, kick = parameters.kick;
    for (int l = 0; l < step_level_count; ++l) {
        const int period = 1 << std::min(l, cycle.levels), place = cycle.index % period;
        Real& duration = parameters.active.duration[static_cast<std::size_t>(l)];
        duration = 0;
        if (place != period / 2) continue;
        // To the end of its period; ahead of time already only where a cycle was broken off or its steps shortened.
        const Real due = period > 1 ? (period - place) * h : kick;
        duration = std::max(0.0, (due - cycle.lead[static_cast<std::size_t>(l)]) / kick);
    }
    const LevelMask mask = parameters.active.mask();
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) {
        unsigned active = bodies.has_touched[b] ? 1u << touched_level : 0;
        for (int k = 0; k < element_level_count; ++k) {
            const int level = std::min(bodies.level[b] + k, static_cast<int>(bodies.level_cap[b]));
            active |= (mask >> level & 1u) << k;
        }
        bodies.active[b] = static_cast<LevelMask>(active);
    }
    // four times in a cycle
    parameters.look_at_elements = cycle.index % std::max(1, (1 << cycle.levels) / 4) == 0;
}

void note_touched_nodes(const ContactTable& contacts, BodyTable& bodies, NodeTable& nodes) {
    for (const Stencil& stencil : contacts.stencil)
        for (std::size_t k = 0; k < stencil.node.size(); ++k) {
            if (stencil.weight[k] == 0) continue;
            const auto n = static_cast<std::size_t>(stencil.node[k]), b = static_cast<std::size_t>(nodes.body[n]);
            if (bodies.blocks[b].size() == 0) continue;
            nodes.touched[n] = touched_cycles;
            bodies.touched[b] = 1;
        }
}

bool impulses_too_long(const StepCycle& cycle, const BodyTable& bodies) {
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) {
        const int highest = std::min(highest_level(bodies, b), cycle.levels);
        if (highest > 0 && bodies.longest_impulse[b] < std::ldexp(cycle.h, highest)) return true;
    }
    return false;
}

void end_cycle(Model& model, const StepCycle& cycle) {
    if (!in_step(cycle, cycle.h)) return;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) note_contacts(model, b);
}

void count_impulses(const StepParameters& parameters, StepCycle& cycle, RunCounters& counters) {
    for (std::size_t l = 0; l < step_level_count; ++l) {
        const Real duration = parameters.active.duration[l];
        const bool every_step = std::min<int>(static_cast<int>(l), cycle.levels) == 0;
        cycle.lead[l] += duration * parameters.kick - (every_step ? parameters.kick : parameters.h);
        counters.element_steps += cycle.elements[l];
        if (duration > 0) counters.element_impulses += cycle.elements[l];
    }
    cycle.index = (cycle.index + 1) % (1 << cycle.levels);
    // What makes one step too long makes the impulses of coarser elements too long.
    constexpr Real rounding = 1e-6;
    if (parameters.h < (1 - rounding) * cycle.h) cycle.index = 0;
}

}  // namespace skerry
