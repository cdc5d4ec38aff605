// Life cycle of a region: load, start, sweep, write back, push out. It is the same for all regions. Regions differ in
// their operator (lumped masses, clusters, bodies) and in the traversal of their contacts (in order, coloured).
#pragma once

#include <algorithm>
#include <atomic>
#include <span>

#include "systems/solver/local/load_sums.h"
#include "systems/solver/methods/run_method.h"
#include "systems/solver/regions/push_out.h"
#include "systems/solver/regions/region_stage.h"

namespace skerry {

/// One region and its rows of the working memory, in the order in which the traversal visits the contacts. The derived
/// class BodyRegion (body_region.h) replaces moves_node() and all member functions that are declared after it.
template <RegionOrder Traversal, class Memory>
struct LoadedRegion {
    std::span<const Index> row;  // by number of the contact in the region: row of ContactTable
    Index base = 0;              // row of the first contact of the region in the columns by contact
    Traversal traversal{};
    Memory memory{};
    LoadSums sums{};
    Real scale = 0;      // the relative solver error is the residual norm divided by this scale [sqrt(J)]
    Real tolerance = 0;  // tolerance of the relative error for this region

    Index row_at(std::size_t position) const { return row[traversal.number_of(position)]; }
    /// True if write_nodes() writes the velocity of the node in velocity row n. BodyRegion returns false for nodes that
    /// move with the frame of a body.
    bool moves_node(const RegionStage&, std::size_t) const { return true; }
    SolverMethod method(const SolverSettings& settings) const { return settings.method; }
    /// Sets the impulses of joints and cables to those of the last step.
    void take_joint_impulses(const RegionStage&) const {}
    /// Solves the region again if its joints would not hold at the end of the step.
    void hold_joints(const RegionStage&, auto&, RegionOutcome&) const {}
    /// Adds the impulse of a contact to the rigid and implicit bodies that it touches, and writes the velocities of its
    /// nodes on these bodies.
    void write_contact(const RegionStage&, std::size_t) const {}
    /// Writes the impulses of joints and cables.
    void write_joints(const RegionStage&) const {}
    /// Writes the pseudo velocities of rigid bodies, which the split impulse has computed.
    void write_body_push(const RegionStage&) const {}
    /// Returns the parts of the split impulse that do not come from contacts: joints, and rotation of capsules and
    /// cylinders.
    PushedContacts pushed(const RegionStage&, const auto&) const { return {}; }
    /// Work that the push-out (split impulse) does against all forces of the step but contact forces, for example
    /// against gravity, when its pseudo velocities displace the nodes [J].
    Real push_work(const RegionStage& stage) const { return push_work_of_nodes(stage, memory, Traversal::own_masses); }
};

/// List of the nodes of a region and their velocities, in the order of their first appearance. RegionMemory::node_index
/// stores the index of each node in the list.
///
/// Regions of a step share no moving node, so their entries do not conflict. An entry left from an earlier step is
/// recognised: at this index the list holds another node or none.
class NodeList {
public:
    /// The list may use at most `room` entries of the columns by node, from `first` on.
    NodeList(RegionMemory& data, std::size_t first, std::size_t room)
        : index_of_node_(data.node_index.span()),
          node_(data.node.span().subspan(first, room)),
          velocity_(data.velocity.span().subspan(first, room)) {}

    /// Returns the index of a node in the list. A new node is added to the list with the velocity that `velocity()`
    /// returns.
    template <class Velocity>
    Index index_of(Index node, Velocity&& velocity) {
        Index& index = index_of_node_[node];
        if (static_cast<std::size_t>(index) < count_ && node_[index] == node) return index;
        index = static_cast<Index>(count_);
        add(node, velocity());
        return index;
    }
    void add(Index node, const Vec4& velocity) {
        node_[count_] = node;
        velocity_[count_++] = velocity;
    }
    std::span<const Index> node() const { return node_; }
    /// Ends loading: shortens the memory of the region to the listed nodes.
    void trim(ContactMemory& memory) const {
        memory.node = memory.node.first(count_);
        memory.velocity = memory.velocity.first(count_);
        memory.scratch = memory.scratch.first(count_);
    }

private:
    std::span<Index> index_of_node_, node_;
    std::span<Vec4> velocity_;
    std::size_t count_ = 0;
};

/// Load: writes the contacts in the order of the traversal, and zero impulses. Adds the sums over contacts to
/// region.sums, which already contains those over joints and cables.
///
/// `load(position, number, contact)` fills a contact and returns the contact velocity without impulses; it may add
/// nodes to the NodeList. `position`: index in the order of the traversal. `number`: index in region.row.
template <class Region, class Load>
void load_contacts(const RegionStage& stage, Region& region, Load&& load) {
    RegionMemory& data = stage.memory;
    const std::size_t first = static_cast<std::size_t>(region.base);
    region.sums = region.traversal.template sum<LoadSums>(region.row.size(), [&](std::size_t begin, std::size_t end) {
        LoadSums sums = region.sums;
        for (std::size_t i = begin; i < end; ++i) {
            LumpedContact& contact = data.contact[first + i];
            const Vec4 u = load(i, region.traversal.number_of(i), contact);
            sums.add(contact, stage.settings.friction, u);
            data.impulse[first + i].setZero();
        }
        return sums;
    });
    region.scale = error_scale(region.sums, stage.inputs.gravity, stage.h, region.tolerance);
}

/// Sets the impulses to those of the last step, and the velocities to those that these impulses cause. For a
/// frictionless contact only the normal part of the impulse is used.
template <class Region, RegionOperator Op>
void take_warm_start(const RegionStage& stage, const Region& region, Op& op) {
    region.traversal.contacts(region.row.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const LumpedContact& contact = region.memory.contact[i];
            if (contact.inverse_diagonal == 0) continue;
            const Vec4 last = padded(stage.out.impulse[region.row_at(i)]);
            region.memory.impulse[i] =
                contact.friction.stick == 0 ? Vec4(contact.normal.dot(last) * contact.normal) : last;
        }
    });
    region.take_joint_impulses(stage);
    op.refresh();
}

/// Start: uses the warm start, unless its error is large and zero impulses have a smaller error. Returns true and sets
/// `outcome` if no sweeps are needed: either no contact closes, or the error of the warm start is within the tolerance.
template <class Region, RegionOperator Op>
bool start_region(const RegionStage& stage, const Region& region, Op& op, RegionOutcome& outcome) {
    const SolverSettings& settings = stage.settings;
    if (settings.fixed_iterations) {
        // If the scale is zero, nothing moves: zero impulses are the solution, and any other start has an infinite
        // relative error. Otherwise the warm start is used even if all contacts separate, because with a fixed number
        // of iterations, sweeps must not depend on how contacts are split into regions.
        if (settings.warm_start == WarmStart::on && region.scale > 0) take_warm_start(stage, region, op);
        return false;
    }
    if (region.sums.separating && settings.skip_separating) {
        outcome = {.status = RegionStatus::certified, .shortcut = shortcut_separating};
        return true;
    }
    if (settings.warm_start == WarmStart::off) return false;
    take_warm_start(stage, region, op);
    const Real error = op.error();
    if (error <= region.tolerance && settings.certify_warm_start) {
        outcome = {.error = error, .status = RegionStatus::certified, .shortcut = shortcut_certified};
        return true;
    }
    if (error <= suspicious_start) return false;
    // Slot 0 of the workspace stores the warm start while the error of zero impulses is measured.
    BestIterate<Op> better(op);
    better.offer(error);
    std::ranges::fill(op.impulse(), Vec4::Zero());
    op.refresh();
    if (error < op.error()) better.restore();
    return false;
}

/// Sweep: runs the solver method of the region from the present impulse.
template <class Region, RegionOperator Op>
RegionOutcome sweep_region(const RegionStage& stage, const Region& region, Op& op) {
    const SolveLimits limits = limits_of(stage.settings, region.tolerance);
    return outcome_of(run_method(region.method(stage.settings), op, limits), stage.settings);
}

/// Writes the velocities of the nodes for which moves_node() is true.
template <class Region>
[[gnu::always_inline]] inline void write_nodes(const RegionStage& stage, const Region& region,
                                               std::span<const Vec4> velocity, std::span<Vec3> out) {
    const std::span<const Index> node = region.memory.node;
    region.traversal.nodes(node.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            if (region.moves_node(stage, n)) out[node[n]] = velocity[n].template head<3>();
    });
}

/// Write back: stores velocities and impulses. Returns the energy that the region's contacts dissipate [J]. This
/// function and finish_region are always inlined: most regions have one contact, and the compiler then removes the
/// loops.
template <class Region>
[[gnu::always_inline]] inline Real write_back(const RegionStage& stage, const Region& region) {
    write_nodes(stage, region, region.memory.velocity, stage.out.velocity_next);
    const Real all = region.traversal.template sum<Real>(region.row.size(), [&](std::size_t begin, std::size_t end) {
        Real dissipated = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const Index row = region.row_at(i);
            region.write_contact(stage, i);
            stage.out.impulse[row] = region.memory.impulse[i].template head<3>();
            dissipated += dissipated_by(stage, row);
        }
        return dissipated;
    });
    region.write_joints(stage);
    return all;
}

/// Finish: writes back, applies the split impulse, and records the dissipated energy.
template <class Region, RegionOperator Op>
[[gnu::always_inline]] inline void finish_region(const RegionStage& stage, const Region& region, const Op& op,
                                                 RegionOutcome& outcome) {
    outcome.dissipated = write_back(stage, region);
    if (outcome.status == RegionStatus::not_finite) return;
    if (!solve_push(stage, region, op)) return;
    write_nodes(stage, region, region.memory.scratch, stage.out.push_out);
    region.write_body_push(stage);
    outcome.push_work = region.push_work(stage);
    stage.memory.pushed.store(true, std::memory_order_relaxed);
}

/// Solves a loaded region. `sweep(op)` runs the solver and returns its outcome.
template <class Region, class Sweep>
RegionOutcome solve_loaded(const RegionStage& stage, const Region& region, Sweep&& sweep) {
    auto op = operator_of(stage, region);
    RegionOutcome outcome;
    if (!start_region(stage, region, op, outcome)) outcome = sweep(op);
    region.hold_joints(stage, op, outcome);
    finish_region(stage, region, op, outcome);
    return outcome;
}
template <class Region>
RegionOutcome solve_loaded(const RegionStage& stage, const Region& region) {
    return solve_loaded(stage, region, [&](auto& op) { return sweep_region(stage, region, op); });
}

}  // namespace skerry
