#include "engine/world/world_report.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/complaint.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
#include "engine/world/state_hash.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/dynamics/checks/volume_ratios.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

Energy energy_of(const Model& model, Real time, Real dissipated) {
    Energy energy;
    const NodeTable& nodes = model.nodes;
    for (std::size_t n = 0; n < nodes.position.size(); ++n) {
        energy.potential -= nodes.mass[n] * model.settings.gravity.dot(nodes.position[n]);
        if (!model.node_has_frame(n)) energy.kinetic += nodes.mass[n] * nodes.velocity[n].squaredNorm() / 2;
    }
    for (const Index body : model.rigid_bodies.body) {
        const RigidSums sums = rigid_sums(model, static_cast<std::size_t>(body));
        energy.kinetic += sums.kinetic;
        energy.elastic += sums.elastic;
    }
    energy.elastic += kernels().elastic_energy(model.all_elements(), model.all_blocks(), nodes.position);
    constexpr Real lag = 0;
    for (const ForceElement* element : force_elements)
        if (element->energy && element->any(model)) energy.elastic += element->energy(model, time, lag);
    energy.dissipated = dissipated;
    return energy;
}

namespace {

/// Counts the elements of a body whose volume ratio det F is below 0.2, if it has smoothed elements. These have the
/// mean deformation gradient F of several tetrahedra. If tetrahedra are compressed against each other, det F can be
/// this small although none is compressed this much.
void count_compressed_elements(const Model& model, std::size_t body, WorldReport& report) {
    constexpr Real compressed = 0.2;
    const Range blocks = model.bodies.blocks[body];
    const ElementInputs elements = model.all_elements();
    const auto of_body =
        elements.count.subspan(static_cast<std::size_t>(blocks.begin), static_cast<std::size_t>(blocks.size()));
    if (std::ranges::all_of(of_body, [](Index count) { return count == 4; })) return;  // only tetrahedra
    const VolumeRatios ratios = element_volume_ratios(elements, blocks, model.nodes.position, compressed);
    if (ratios.near_inversion == 0) return;
    if (report.folded == 0) {
        const Index element = ratios.item - blocks.begin * static_cast<Index>(element_lanes);
        report.folded_body = model.body_records[body].name;
        report.folded_element = model.body_records[body].element_tetrahedra[static_cast<std::size_t>(element)].front();
    }
    report.folded += ratios.near_inversion;
}

/// Elastic energy that rounding errors can cause [J]: that of the strain which rounding of the positions can cause in
/// ten thousand steps. It is the least energy by which the report divides the energy error. Bodies at rest without
/// weight need it, because they exchange no energy.
Real energy_of_rounding(const Model& model) {
    constexpr Real digits = 1e4 * std::numeric_limits<Real>::epsilon();
    Real sum = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        if (model.bodies.blocks[b].size() == 0) continue;
        Real farthest = 0;  // [m]
        for (Index n = model.bodies.nodes[b].begin; n < model.bodies.nodes[b].end; ++n)
            farthest = std::max(farthest, model.nodes.position[static_cast<std::size_t>(n)].norm());
        // sum of volume times Young's modulus: twice the elastic energy divided by the squared strain [J]
        Real stiffness = 0;
        for (auto block = static_cast<std::size_t>(model.bodies.blocks[b].begin);
             block < static_cast<std::size_t>(model.bodies.blocks[b].end); ++block) {
            const auto material = static_cast<std::size_t>(model.elements.material[block]);
            for (const Real volume : model.elements.volume[block].lane)
                stiffness += volume * model.materials.young_modulus[material];
        }
        const Real strain = digits * (1 + farthest / model.bodies.min_altitude[b]);
        sum += stiffness * strain * strain / 2;
    }
    return sum;
}

}  // namespace

std::string DynamicsChoice::message() const {
    const DynamicsEstimate& e = estimate;
    const auto cost_text = [](Real cost, Real step) {
        return short_text(cost) + " s of CPU time per simulated second, in steps of " + short_text(step) + " s";
    };
    const std::string implicit =
        cost_text(e.implicit_cost, e.implicit_step) +
        (e.deforming_step > e.implicit_step ? ", with deformation steps of " + short_text(e.deforming_step) + " s"
                                            : "");
    const bool is_implicit = dynamics == BodyDynamics::implicit_elastic;
    std::string text(name_of(dynamics));
    if (e.reason == DynamicsReason::given) return text;
    if (e.reason == DynamicsReason::self_contact) return text + ", because the body can touch itself";
    if (e.reason == DynamicsReason::losses) return text + ", because a material of the body sets a loss_factor";
    if (e.reason == DynamicsReason::plasticity) return text + ", because a material of the body yields";
    if (e.reason == DynamicsReason::strain)
        return text + ", because the body may deform by " + short_text(100 * e.strain) + " %";
    text += ": " + (is_implicit ? implicit : cost_text(e.explicit_cost, e.explicit_step)) +
            (is_implicit ? "; explicit: " + cost_text(e.explicit_cost, e.explicit_step) : "; implicit: " + implicit);
    if (is_implicit && e.damped_above > 0)
        text += "; vibrations above " + short_text(e.damped_above) + " Hz are damped";
    return text;
}

std::string WorldReport::distrust() const {
    if (crossed > 0)
        return "surfaces passed through each other at " + std::to_string(crossed) +
               " nodes or edges, so positions, forces and energies cannot be trusted; leave more room between the "
               "objects that press on a body, or shorten the step";
    if (worst_error > largest_trusted_error) {
        const std::string region = worst_region == 0
                                       ? "a region of joints or cables without contacts"
                                       : "a contact region of " + std::to_string(worst_region) + " contacts";
        return region + " was left unsolved with a relative error of " + short_text(worst_error) + ", more than " +
               short_text(largest_trusted_error) +
               ", so positions, forces and energies cannot be trusted; increase max_iterations, or reduce the load on "
               "the bodies";
    }
    return {};
}

std::string StepReport::message() const {
    const std::string body_text = body_name.empty() ? "a body" : "body '" + body_name + "'";
    const std::string location = (node < 0 ? "" : ", node " + std::to_string(node)) +
                                 (element < 0 ? "" : ", element " + std::to_string(element));
    switch (status) {
        case StepStatus::ok:
            return {};
        case StepStatus::stopped:
            return "stopped on request, between two steps";
        case StepStatus::not_finite:
            return "the step was not taken: " + body_text + location +
                   " would get a velocity that is not finite; check the loads, masses and initial velocities of the "
                   "body";
        case StepStatus::too_fast:
            return "the step was not taken: " + body_text + location + " would deform by a strain of " +
                   short_text(value) +
                   " in one step, even in 1/1024 of the stable step; lower the velocities and loads of the body";
        case StepStatus::too_far:
            return "the step was not taken: " + body_text +
                   " is so far from the origin that neighbouring representable positions are " + short_text(value) +
                   " of its mean edge length apart; use a local frame whose origin is near the bodies";
        case StepStatus::unsolved:
            return "the step was not taken: Newton's method for large strain did not converge for " + body_text +
                   ", even with a thousandth of the step; check the loads, velocities and shape of the body, or set "
                   "its dynamics to explicit";
        case StepStatus::too_stiff:
            return "the step was not taken: " + body_text + " has a stable step of only " + short_text(value) +
                   " s, which is too short to advance the time; check the material, size and shape of the body, and "
                   "springs, "
                   "cables, cavities, fibres and loads on it";
    }
    return {};
}

std::string StepReport::warning() const {
    std::string text;
    if (limited > 0)
        text = "step_size exceeds the stable step of body '" + limited_by + "': steps that were shortened to at most " +
               short_text(limited_step) + " s: " + std::to_string(limited);
    if (inverted > 0)
        text += (text.empty() ? "" : "; ") + std::string("inverted elements: ") + std::to_string(inverted) +
                ", the first of them element " + std::to_string(inverted_element) + " of body '" + inverted_name + "'";
    return text;
}

std::uint64_t World::state_hash() const {
    state_->settle();
    return skerry::state_hash(*state_);
}
Energy World::energy() const {
    state_->settle();
    return energy_of(state_->model, state_->clock.time, state_->record.counters.dissipated);
}

namespace {

void note_fastest_turn(const Model& model, WorldReport& report) {
    const ColliderTable& colliders = model.colliders;
    const Real step = longest_allowed_step(model);
    if (!std::isfinite(step)) return;  // no body limits the step
    for (std::size_t c = 0; c < colliders.slot.size(); ++c) {
        const Real turn = step * fastest_turn(colliders.script[c], colliders.keyframe);
        if (!(turn > report.collider_turn)) continue;
        report.collider_turn = turn;
        report.turning_collider = model.collider_records[c].name;
    }
}

/// Writes to the report the deepest overlap of surfaces whose motion is prescribed, and the names of the two objects if
/// both still exist.
void note_held(const WorldState& world, WorldReport& report) {
    const Model& model = world.model;
    report.held_penetration = world.record.held.depth;
    if (world.record.held.pair == HeldDepth::no_pair) return;
    const PairSlots pair = slots_of_pair(world.record.held.pair);
    const bool has_second =
        pair.is_collider ? model.collider_map.has_slot(pair.second) : model.body_map.has_slot(pair.second);
    if (!model.body_map.has_slot(pair.first) || !has_second) return;
    const auto name_of_body = [&](std::uint32_t slot) -> const std::string& {
        return model.body_records[static_cast<std::size_t>(model.body_map.row(model.body_map.handle_of_slot(slot)))]
            .name;
    };
    report.held_body = name_of_body(pair.first);
    const auto& colliders = model.collider_map;
    report.held_in =
        pair.is_collider
            ? model.collider_records[static_cast<std::size_t>(colliders.row(colliders.handle_of_slot(pair.second)))]
                  .name
            : name_of_body(pair.second);
}

}  // namespace

WorldReport World::report() const {
    state_->settle();
    const WorldState& world = *state_;
    WorldReport report;
    static_cast<RunCounters&>(report) = world.record.counters;
    report.time = world.clock.time;
    for (BodyKind kind : world.model.bodies.kind) report.bodies += kind == BodyKind::deformable;
    for (std::uint8_t asleep : world.model.bodies.asleep) report.asleep += asleep != 0;
    report.colliders = world.model.colliders.slot.size();
    report.nodes = world.model.nodes.position.size();
    for (Index count : world.model.bodies.tetrahedron_count) report.elements += static_cast<std::size_t>(count);
    Index stiffest = no_index;
    settle_clusters(state_->model, state_->scratch.stiffness_sum);
    report.clusters = world.model.clusters.size();
    report.cluster_nodes = world.model.clusters.nodes.item.size();
    for (std::size_t block = 0; block < world.model.elements.implicit_modulus.size(); ++block)
        for (const Real m : world.model.elements.implicit_modulus[block].lane)
            (world.model.elements.part[block] == ElementPart::guard ? report.guards : report.implicit_elements) +=
                m > 0;
    if (world.model.force_rate_moves) note_force_rates(state_->model);
    report.stable_step = reported_step(world.model, &stiffest);
    report.stable_step_body = name_body(world, world_row_of_stiffest(world, stiffest)).name;
    for (std::size_t b = 0; b < world.model.body_records.size(); ++b)
        if (const BodyRecord& record = world.model.body_records[b]; record.choice.reason != DynamicsReason::given)
            report.dynamics_choices.push_back({world.model.body_map.handle_of_slot(world.model.bodies.slot[b]),
                                               record.name, world.model.dynamics_of(b), record.choice});
    note_fastest_turn(world.model, report);
    report.start_overlaps = world.record.start_overlaps;
    report.start_moves = world.record.start_moves;
    report.self_crossings = world.record.self_crossings;
    find_self_crossings(*state_->executor, state_->model, report.time, state_->scratch.self_crossing_places,
                        report.self_crossings);
    report.step_limits = world.record.limits.report();
    for (const StageStats& stage : world.graph.stats())
        report.stages.push_back({stage.name, stage.seconds, stage.runs, stage.skipped});
    const auto mean = [](std::uint64_t sum, std::uint64_t count) {
        return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 0;
    };
    report.mean_contacts = mean(report.contact_sum, report.steps);
    report.mean_regions = mean(report.solved, report.steps);
    report.mean_iterations = mean(report.iteration_sum, report.solved);
    report.broad_searches = world.cache.search.broad_searches;
    report.pair_searches = world.cache.search.pair_searches;
    report.candidates = world.cache.search.candidate_count;
    report.crossing_tests = world.cache.crossings.tested;
    report.crossings_found = world.cache.crossings.hits;
    report.crossed = world.cache.crossings.let_through;
    note_held(world, report);
    report.energy = energy_of(world.model, world.clock.time, report.dissipated);
    for (const Index body : world.model.rigid_bodies.body) {
        const RigidSums sums = rigid_sums(world.model, static_cast<std::size_t>(body));
        report.momentum += sums.momentum;
        report.angular_momentum += sums.angular_momentum;
    }
    for (std::size_t n = 0; n < world.model.nodes.position.size(); ++n) {
        if (world.model.node_has_frame(n)) continue;
        const Vec3 momentum = world.model.nodes.mass[n] * world.model.nodes.velocity[n];
        report.momentum += momentum;
        report.angular_momentum += world.model.nodes.position[n].cross(momentum);
    }
    for (std::size_t b = 0; b < world.model.bodies.slot.size(); ++b) {
        if (world.model.bodies.tetrahedron_blocks[b].size() == 0 || world.model.is_rigid(b)) continue;
        const VolumeRatios ratios =
            tetrahedron_volume_ratios(world.model.tetrahedra.node, world.model.tetrahedra.volume,
                                      world.model.bodies.tetrahedron_blocks[b], world.model.nodes.position);
        report.near_inversion += ratios.near_inversion;
        report.inverted += ratios.inverted;
        count_compressed_elements(world.model, b, report);
        if (ratios.smallest >= report.worst_volume_ratio) continue;
        report.worst_volume_ratio = ratios.smallest;
        report.worst_volume_body = world.model.body_records[b].name;
        report.worst_volume_element = world.model.user_tetrahedron(b, ratios.item);
    }
    const Balance balance = checked_balance(world, world.clock.time, lag_between_steps(world), world.record.balance);
    const auto share = [](Real part, Real whole) { return whole > 0 ? part / whole : 0; };
    report.energy_error = balance.energy_error;
    report.energy_error_share =
        share(balance.energy_error, std::max(balance.energy_scale, energy_of_rounding(world.model)));
    report.momentum_error = balance.momentum_known ? balance.momentum_error : std::numeric_limits<Real>::quiet_NaN();
    report.momentum_error_share = share(report.momentum_error, balance.momentum_scale);
    report.balanced_steps = balance.steps;
    return report;
}

}  // namespace skerry
