// Stable steps of bodies, and limits of the step length.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/world/kernels.h"
#include "engine/world/step/step.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/clusters/stiffen_clusters.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/stiffness_share.h"
#include "systems/dynamics/stability/strained_step.h"
#include "systems/dynamics/stability/watch_stable_steps.h"

namespace skerry {

namespace {

// Longest step in worlds with rigid or implicit bodies, unless the settings give a step [s]. The errors of contacts
// that close within a step, and of contacts with rotating faces, grow with the step length.
constexpr Real step_of_rigid_bodies = 1.0 / 120;

/// Entry of a body in the column `of_body`; zero if the body was added after the column was computed.
Real bound_of(const Column<Real>& of_body, std::size_t body) {
    return body < of_body.size() ? of_body[body] : 0;
}

}  // namespace

Real step_of_body(const Model& model, std::size_t body) {
    Real step = model.bodies.stable_step[body];
    // Adds bounds of squared circular frequencies: 4 / step^2 for the elements, and `rate` for the force elements. The
    // sum bounds those of both together (Weyl's inequality, docs/methods/stable_step.md 6.2).
    if (const Real rate = bound_of(model.force_rate, body); rate > 0) step = 2 / std::sqrt(4 / (step * step) + rate);
    const Index material = model.bodies.material[body];
    Real damping = material == no_index ? 0 : model.materials.damping[static_cast<std::size_t>(material)];
    damping += bound_of(model.force_damping, body);
    // In each step of length h, damping multiplies velocities by k = exp(-damping h). A mode of the circular frequency
    // omega is stable if (omega h)^2 < 2 (1 + k) (docs/methods/stable_step.md 6.1). Here k is computed for h = `step`.
    // The result is at most this h, so its k is at least as large.
    const Real one_plus_k = damping > 0 && std::isfinite(step) ? 1 + std::exp(-damping * step) : 2;
    step *= std::sqrt(one_plus_k / 2);
    const Real drag = bound_of(model.force_drag, body);
    if (!(drag > 0)) return step;
    // Drag forces -c m v with the rate c change the condition to (omega h)^2 < 2 (1 + k - c h). The result is the h for
    // which both sides are equal, but at most 1/c, so that drag does not reverse velocities. For bodies without
    // elements, 1/c is the only limit.
    const Real drag_share = std::isfinite(step) ? drag * step / (2 * one_plus_k) : 0;
    return std::min(std::isfinite(step) ? step * (std::sqrt(1 + drag_share * drag_share) - drag_share) : step,
                    1 / drag);
}

Real stable_step(const Model& model, Index* body) {
    Real smallest = infinity;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        if (model.bodies.is_ghost(b)) continue;  // the owner of the body counts its stable step
        const Real step = step_of_body(model, b);
        if (!(step < smallest)) continue;
        smallest = step;
        if (body) *body = static_cast<Index>(b);
    }
    if (!(model.of_ranks.stable_step <= smallest) || model.of_ranks.stiffest == no_index) return smallest;
    if (body) *body = no_index;
    return model.of_ranks.stable_step;
}

bool is_strained(const Model& model, std::size_t body) {
    // Strain counts as the cause of a short step if the stable step of the body is less than this fraction of its
    // stable step at rest. Otherwise the rest shape is the cause.
    constexpr Real as_at_rest = 0.9;
    return model.bodies.stable_step[body] < as_at_rest * model.bodies.rest_step[body];
}

Real reported_step(const Model& model, Index* body) {
    const Real stable = stable_step(model, body);
    return (model.rigid_bodies.size() > 0 || model.of_ranks.has_frames) && std::isinf(stable)
               ? longest_allowed_step(model)
               : stable;
}

Real longest_allowed_step(const Model& model, Index* body) {
    const Real stable = stable_step(model, body) * model.tuning.step_safety;
    Real wanted = model.rigid_bodies.size() > 0 || model.of_ranks.has_frames ? step_of_rigid_bodies : stable;
    if (model.settings.step_size) wanted = *model.settings.step_size;
    if (model.settings.implicit_step > 0 && (model.implicit_nodes.size() > 0 || model.of_ranks.has_implicit))
        wanted = std::min(wanted, model.settings.implicit_step);
    return std::min(stable, wanted);
}

Real step_with_frame(const Model& model) {
    return std::min(stable_step(model) * model.tuning.step_safety,
                    model.settings.step_size.value_or(step_of_rigid_bodies));
}

namespace {

/// Returns a stable step for the explicit elements of a body [s]: `stable`, or for a body with clusters a longer one,
/// if the bound of docs/methods/stable_step.md 2.5 allows it. This is so if the body is strained in a few places only.
/// `longest`: length above which a longer result is of no use [s].
Real strained_step_of(const Model& model, std::size_t body, std::span<const Vec3> position, Real longest, Real stable,
                      Column<Real>& memory) {
    const Range blocks = model.bodies.blocks[body], nodes = model.bodies.nodes[body];
    const ElementInputs elements = model.all_elements();
    if (!(model.bodies.cluster_step[body] > 0) || !has_mass_form(elements, static_cast<std::size_t>(blocks.begin)) ||
        !(stable > 0) || !(stable < longest))
        return stable;
    memory.resize(std::max(memory.size(), strained_step_memory(nodes, blocks)));
    return std::max(stable, kernels().strained_step(elements, blocks, nodes, position, model.nodes.mass,
                                                    {longest, stable}, memory.span()));
}

/// Stable step of the explicit elements of a body for the given node positions [s].
Real explicit_step(const Model& model, std::size_t body, std::span<const Vec3> position, Column<Real>& stiffness_sum) {
    stiffness_sum.resize(position.size());
    const Real step =
        kernels()
            .stable_step(model.all_elements(), model.bodies.blocks[body], position, model.nodes.mass, stiffness_sum)
            .step;
    return strained_step_of(model, body, position, model.bodies.rest_step[body], step, stiffness_sum);
}

/// Stable step of a body with its clusters [s]; NaN for an invalid shape. If an element of a cluster is stiffer than
/// assumed by a factor s > 1, the cluster is stable up to cluster_step / sqrt(s) only. `step`: stable step of the
/// explicit elements of the body [s].
Real within_clusters(const Model& model, std::size_t body, std::span<const Vec3> position, Real step) {
    const Real of_clusters = model.bodies.cluster_step[body];
    if (!(of_clusters > 0)) return step;
    const Range blocks = model.bodies.blocks[body];
    const Real stiffening =
        worst_stiffening(model.all_elements(), blocks, position, rows_of(model.elements.implicit_modulus, blocks));
    return std::min(step, of_clusters / std::sqrt(stiffening > 1 ? stiffening : Real(1)));
}

}  // namespace

Real evaluate_stable_step(const Model& model, std::size_t body, std::span<const Vec3> position,
                          Column<Real>& stiffness_sum) {
    return within_clusters(model, body, position, explicit_step(model, body, position, stiffness_sum));
}

namespace {

/// Stores newly evaluated stable steps, body by body. Makes elements implicit where clusters reduce the computing time.
class CheckedSteps {
public:
    CheckedSteps(Model& model, Column<Real>& stiffness_sum)
        : model_(model), stiffness_sum_(stiffness_sum), goal_(model.of_ranks.rest_step) {
        const BodyTable& bodies = model.bodies;
        for (std::size_t b = 0; b < bodies.slot.size(); ++b)
            if (bodies.blocks[b].size() > 0) goal_ = std::min(goal_, bodies.rest_step[b]);
    }

    void take(std::size_t b, Real step) {
        // If the stable step of a body is shorter than goal_ / worth_clusters, its elements that are unstable at the
        // step length reserve * goal_ become implicit. They stay implicit when their strain decreases.
        // - In a body without clusters, reserve > 1 lets the body stay stable until the next evaluation.
        // - In a body with clusters, worth_clusters is larger, so elements become implicit later, and reserve < 1, so
        //   fewer do.
        const bool has_clusters = model_.bodies.cluster_step[b] > 0;
        const Real worth_clusters = has_clusters ? 2.5 : 1.25, reserve = has_clusters ? 1 / 1.5 : 1.05;
        BodyTable& bodies = model_.bodies;
        if (step < 0.9 * goal_) step = strained_step_of(model_, b, model_.nodes.position, goal_, step, stiffness_sum_);
        bodies.stable_step[b] = within_clusters(model_, b, model_.nodes.position, step);
        if (!(bodies.stable_step[b] > 0) || bodies.stable_step[b] * worth_clusters >= goal_ ||
            !clusters_allowed(model_.settings))
            return;
        const Real before = changed_.empty() ? added_energy(model_) : energy_before_;
        stiffness_sum_.resize(model_.nodes.position.size());
        if (!make_implicit(model_, b, reserve * goal_, bodies.stable_step[b], stiffness_sum_)) return;
        energy_before_ = before;
        changed_.resize(bodies.slot.size());
        changed_[b] = 1;
        bodies.stable_step[b] = evaluate_stable_step(model_, b, model_.nodes.position, stiffness_sum_);
    }

    /// Rebuilds the clusters of bodies with new implicit elements. Returns the kinetic energy that their inertia adds
    /// [J].
    Real end() {
        model_.clusters_grew = !changed_.empty();
        if (changed_.empty()) return 0;
        model_.rebuild_clusters(changed_);
        return added_energy(model_) - energy_before_;
    }

private:
    Model& model_;
    Column<Real>& stiffness_sum_;
    Real goal_;               // shortest stable step at rest among all bodies [s]
    Real energy_before_ = 0;  // J
    // for each body, nonzero if its implicit elements have changed; empty: no body has changed
    std::vector<std::uint8_t> changed_;
};

}  // namespace

Real evaluate_stable_steps(Model& model, Column<Real>& stiffness_sum) {
    CheckedSteps checked(model, stiffness_sum);
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.blocks[b].size() > 0)
            checked.take(b, explicit_step(model, b, model.nodes.position, stiffness_sum));
    model.watch.begin_round();
    return checked.end();
}

Real use_evaluated_steps(Model& model, Column<Real>& stiffness_sum) {
    StepWatch& watch = model.watch;
    CheckedSteps checked(model, stiffness_sum);
    for (std::size_t b = 0; b < static_cast<std::size_t>(watch.body); ++b)
        if (model.bodies.blocks[b].size() > 0 && watch.step[b] != StepWatch::not_evaluated)
            checked.take(b, watch.step[b]);
    watch.begin_round();
    return checked.end();
}

namespace {

/// Message to other ranks: number of pieces into which the evaluation of a body's stable step is divided. `world_row`:
/// row of the body in the undivided world.
struct PiecesOfBody {
    Index world_row;
    std::uint32_t pieces;
};

/// Computes RankState::pieces_before: for each row of the undivided world, the number of pieces of all bodies in
/// earlier rows. The last entry is the number of all pieces. Collective.
void gather_pieces(const Model& model, RankState& ranks) {
    std::vector<PiecesOfBody> own_pieces;
    const ElementInputs elements = model.all_elements();
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (ranks.owns(b))
            own_pieces.push_back(
                {ranks.world_row[b], static_cast<std::uint32_t>(pieces_of_check(elements, model.bodies.blocks[b]))});
    ranks.pieces_before.clear();
    for_each_gathered<PiecesOfBody>(*ranks.ranks, own_pieces, [&](const PiecesOfBody& body) {
        const auto world_row = static_cast<std::size_t>(body.world_row);
        ranks.pieces_before.resize(std::max(ranks.pieces_before.size(), world_row + 2), 0);
        ranks.pieces_before[world_row + 1] = body.pieces;
    });
    for (std::size_t world_row = 1; world_row < ranks.pieces_before.size(); ++world_row)
        ranks.pieces_before[world_row] += ranks.pieces_before[world_row - 1];
}

}  // namespace

void count_pieces(WorldState& world) {
    const Model& model = world.model;
    RankState& ranks = world.ranks;
    Column<std::uint64_t>& first = world.model.watch.first_piece;
    const std::size_t rows = model.bodies.slot.size();
    first.assign(rows + 1, 0);
    if (!ranks.on()) {
        const ElementInputs elements = model.all_elements();
        for (std::size_t b = 0; b < rows; ++b)
            first[b + 1] = first[b] + pieces_of_check(elements, model.bodies.blocks[b]);
        return;
    }
    if (ranks.pieces_before.empty()) gather_pieces(model, ranks);
    for (std::size_t b = 0; b < rows; ++b) first[b] = ranks.pieces_before[static_cast<std::size_t>(ranks.world_row[b])];
    if (!ranks.pieces_before.empty()) first[rows] = ranks.pieces_before[ranks.pieces_before.size() - 1];
}

void store_shapes(Executor& executor, Model& model, std::uint64_t round) {
    const BodyTable& bodies = model.bodies;
    StepWatch& watch = model.watch;
    const auto rows = static_cast<Index>(bodies.slot.size());
    const ElementInputs elements = model.all_elements();
    const auto share = static_cast<Real>(std::min(watch.steps + 1, round)) / static_cast<Real>(round);
    watch.target =
        static_cast<std::uint64_t>(std::ceil(share * static_cast<Real>(watch.first_piece[bodies.slot.size()])));
    // New entries are set to 0, so that the bytes of a saved world do not depend on chance: entries that are not used
    // yet are saved too.
    watch.position.resize(model.nodes.position.size(), Vec3::Zero());
    watch.stiffness_sum.resize(model.nodes.position.size());
    watch.step.resize(bodies.slot.size());
    const auto first = static_cast<std::size_t>(watch.kept);
    const auto is_due = [&](std::size_t row) {
        return watch.first_piece[row] < watch.target || pieces_of_check(elements, bodies.blocks[row]) == 0;
    };
    while (watch.kept < rows && is_due(static_cast<std::size_t>(watch.kept))) ++watch.kept;
    parallel_for(executor, static_cast<std::size_t>(watch.kept) - first, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = first + begin; b < first + end; ++b) {
            const bool keeps_its_shape = bodies.asleep[b] || bodies.unstrained[b] > 0 || bodies.is_led(b);
            watch.step[b] = keeps_its_shape ? StepWatch::not_evaluated : 0;
            if (keeps_its_shape) continue;
            std::ranges::copy(rows_of(model.nodes.position, bodies.nodes[b]),
                              rows_of(watch.position, bodies.nodes[b]).begin());
            std::ranges::fill(rows_of(watch.stiffness_sum, bodies.nodes[b]), Real(0));
        }
    });
}

Real follow_stiffening(Model& model) {
    if (model.clusters.empty()) return 0;
    return stiffen_all_clusters(model.all_elements(), StiffenInputs::bind(Binder(), model.bodies, model.nodes),
                                StiffenOutputs::bind(Binder(), model.elements, model.clusters));
}

}  // namespace skerry
