// What a world tells about itself: sums over its tables, energies, and the hash of its state.
#include <Eigen/Geometry>
#include <cstdio>
#include <cstring>
#include <limits>

#include "engine/world/world_state.h"
#include "systems/dynamics/element_energy.h"

namespace skerry {

namespace {

/// FNV-1a over 64-bit words: not cryptographic, but any change of a bit changes it.
class Hash {
public:
    void add(std::uint64_t word) {
        value_ ^= word;
        value_ *= 0x100000001b3ull;
        value_ ^= value_ >> 29;
    }
    void add(const void* data, std::size_t bytes) {
        const auto* at = static_cast<const unsigned char*>(data);
        for (; bytes >= 8; at += 8, bytes -= 8) {
            std::uint64_t word;
            std::memcpy(&word, at, 8);
            add(word);
        }
        if (bytes == 0) return;
        std::uint64_t rest = 0;
        std::memcpy(&rest, at, bytes);
        add(rest);
    }
    template <class T>
    void add(const Column<T>& column) {
        add(column.size());
        add(column.data(), column.size() * sizeof(T));
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ull;
};

}  // namespace

std::uint64_t hash_of(WorldState& world) {
    Hash hash;
    const auto add = [&hash](const char*, const auto& column) { hash.add(column); };
    hash.add(&world.step.time, sizeof world.step.time);
    world.nodes.for_each_state_column(add);
    world.elements.for_each_state_column(add);
    world.warm_start.for_each_column(add);
    hash.add(world.bodies.asleep);
    hash.add(world.bodies.calm);
    hash.add(static_cast<std::uint64_t>(world.step.cycle.index));
    hash.add(&world.step.cycle.lead, sizeof world.step.cycle.lead);
    return hash.value();
}

Index user_element(const WorldState& world, std::size_t body, Index element) {
    const Index place = element - static_cast<Index>(element_lanes) * world.bodies.blocks[body].begin;
    const std::vector<Index>& order = world.body_records[body].element_order;
    return order.empty() ? place : order[static_cast<std::size_t>(place)];
}

Energy energy_of(const WorldState& world) {
    Energy energy;
    const NodeTable& nodes = world.nodes;
    for (std::size_t n = 0; n < nodes.position.size(); ++n) {
        energy.kinetic += nodes.mass[n] * nodes.velocity[n].squaredNorm() / 2;
        energy.potential -= nodes.mass[n] * world.step.gravity.dot(nodes.position[n]);
    }
    energy.elastic = elastic_energy(world.element_inputs(), {0, static_cast<Index>(world.elements.node.size())}, nodes.position);
    energy.dissipated = world.counters.dissipated;
    return energy;
}

namespace {

std::string short_text(Real value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

}  // namespace

std::string StepReport::message() const {
    const std::string who = body_name.empty() ? "a body" : "body '" + body_name + "'";
    const std::string where =
        (node < 0 ? "" : ", node " + std::to_string(node)) + (element < 0 ? "" : ", element " + std::to_string(element));
    switch (status) {
        case StepStatus::ok:
            return {};
        case StepStatus::not_finite:
            return "the step was not taken: " + who + where +
                   " would get a velocity that is not finite; check its loads, masses and initial velocities";
        case StepStatus::too_fast:
            return "the step was not taken: " + who + where + " would move by " + short_text(value) +
                   " of its smallest element altitude in one step; in a sixty-fourth of the stable step, too; lower its velocities and "
                   "loads, or raise "
                   "max_strain_step";
        case StepStatus::too_far:
            return "the step was not taken: " + who + " is so far from the origin that neighbouring positions are " + short_text(value) +
                   " of its mean edge apart; put the origin near the bodies, by a local frame of the scene";
        case StepStatus::too_stiff:
            return "the step was not taken: " + who + " stands no step longer than " + short_text(value) +
                   " s, with which time would not go on; check its material, size and shape";
    }
    return {};
}

std::string StepReport::warning() const {
    std::string text;
    if (limited > 0)
        text = "step_size is longer than body '" + limited_by + "' stands: " + std::to_string(limited) +
               " steps were taken at no more than " + short_text(limited_step) + " s";
    if (inverted > 0)
        text += (text.empty() ? "" : "; ") + std::to_string(inverted) + " elements turned inside out, the first of them element " +
                std::to_string(inverted_element) + " of body '" + inverted_name + "'";
    return text;
}

std::uint64_t World::state_hash() const {
    return hash_of(*state_);
}
Energy World::energy() const {
    return energy_of(*state_);
}

WorldReport World::report() const {
    const WorldState& world = *state_;
    const RunCounters& counters = world.counters;
    WorldReport report;
    report.time = world.step.time;
    report.steps = counters.steps;
    for (BodyKind kind : world.bodies.kind) report.bodies += kind == BodyKind::deformable;
    for (std::uint8_t asleep : world.bodies.asleep) report.asleep += asleep != 0;
    report.colliders = world.colliders.slot.size();
    report.nodes = world.nodes.position.size();
    for (Index count : world.bodies.element_count) report.elements += static_cast<std::size_t>(count);
    Index stiffest = no_index;
    report.stable_step = skerry::stable_step(world, &stiffest);
    if (stiffest != no_index) report.stable_step_body = world.body_records[static_cast<std::size_t>(stiffest)].name;
    for (const StageStats& stage : world.graph.stats()) report.stages.push_back({stage.name, stage.seconds, stage.runs, stage.skipped});
    const double steps = counters.steps > 0 ? static_cast<double>(counters.steps) : 1;
    report.mean_contacts = static_cast<double>(counters.contacts) / steps;
    report.mean_regions = static_cast<double>(counters.regions) / steps;
    report.mean_iterations = counters.regions > 0 ? static_cast<double>(counters.iterations) / static_cast<double>(counters.regions) : 0;
    report.max_contacts = counters.max_contacts;
    report.max_regions = counters.max_regions;
    report.largest_region = counters.largest_region;
    report.worst_error = counters.worst_error;
    report.worst_region = counters.worst_region;
    report.unconverged = counters.unconverged;
    report.certified = counters.certified;
    report.closed_form = counters.closed_form;
    report.separating = counters.separating;
    report.frictionless = counters.frictionless;
    report.in_lanes = counters.in_lanes;
    report.frozen = counters.frozen;
    report.contact_steps = counters.contact_steps;
    report.swept = counters.swept;
    report.solved = counters.regions;
    report.broad_searches = world.search.broad_searches;
    report.pair_searches = world.search.pair_searches;
    report.candidates = world.search.candidate_count;
    const auto& levels = world.step.cycle.elements;
    for (std::size_t l = 0; l < levels.size(); ++l)
        if (levels[l] > 0) {
            report.level_elements.resize(l + 1);
            report.level_elements[l] = levels[l];
        }
    report.element_steps = counters.element_steps;
    report.element_impulses = counters.element_impulses;
    report.inline_steps = counters.inline_steps;
    report.shortened = counters.shortened;
    report.retried = counters.retried;
    report.inversions = counters.inversions;
    report.crossing_tests = world.crossings.tested;
    report.crossings_found = world.crossings.hits;
    report.crossed = world.crossings.let_through;
    report.limited = counters.limited;
    report.energy = energy_of(world);
    for (std::size_t n = 0; n < world.nodes.position.size(); ++n) {
        const Vec3 momentum = world.nodes.mass[n] * world.nodes.velocity[n];
        report.momentum += momentum;
        report.angular_momentum += world.nodes.position[n].cross(momentum);
    }
    report.max_penetration = counters.max_penetration;
    report.max_gap_violation = counters.max_gap_violation;
    for (std::size_t b = 0; b < world.bodies.slot.size(); ++b) {
        if (world.bodies.element_count[b] == 0) continue;
        const VolumeRatios ratios = measure_volume_ratios(world.element_inputs(), world.bodies.blocks[b], world.nodes.position);
        report.near_inversion += ratios.near_inversion;
        report.inverted += ratios.inverted;
        if (ratios.smallest >= report.worst_volume_ratio) continue;
        report.worst_volume_ratio = ratios.smallest;
        report.worst_volume_body = world.body_records[b].name;
        report.worst_volume_element = user_element(world, b, ratios.element);
    }
    const Balance balance = checked_balance(world);
    const auto share = [](Real of, Real whole) { return whole > 0 ? of / whole : 0; };
    report.energy_error = balance.energy_error;
    report.energy_error_share = share(balance.energy_error, balance.energy_scale);
    report.momentum_error = balance.momentum_known ? balance.momentum_error : std::numeric_limits<Real>::quiet_NaN();
    report.momentum_error_share = share(report.momentum_error, balance.momentum_scale);
    report.balanced_steps = balance.steps;
    return report;
}

}  // namespace skerry
