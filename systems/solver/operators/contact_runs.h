// Sweeps over contacts on implicit bodies (docs/methods/implicit_bodies.md 4).
//
// An impulse on a node moves all touched nodes of its body, those with contacts, but the next contacts of a sweep need
// only the velocities of their own nodes. So the contacts are divided into *runs*: sequences of consecutive contacts
// with few nodes.
// - During a run, impulses move only the nodes of the run.
// - At the end of the run, the sums of the impulses by node move all other touched nodes.
//
// The result is that of a sweep without runs, up to rounding.
#pragma once

#include <array>
#include <span>

#include "components/column.h"
#include "components/implicit_coupling.h"
#include "systems/solver/local/lumped_contact.h"
#include "systems/solver/operators/through_groups.h"

namespace skerry {

using PaddedMat3 = Eigen::Matrix<Real, 4, 3>;  // a 3x3 matrix padded with a row of zeros

/// Impulses on nodes of one implicit body, and the velocities that they cause at all nodes of the body that have
/// contacts (the touched nodes).
class SpreadImpulses {
public:
    SpreadImpulses() = default;
    void start() {
        column_.clear();
        factor_.clear();
    }
    void add(const ImplicitCoupling& coupling, std::size_t body, Index touched_index, const Vec4& impulse);
    bool empty() const { return factor_.empty(); }
    /// Velocities of the touched nodes in the frame of the body, three numbers per node [m/s]. Valid until the next
    /// call.
    std::span<const Real> velocities(std::size_t numbers);

private:
    Column<const Real*> column_;  // columns of ImplicitCoupling::response
    Column<Real> factor_;         // [N s]
    Column<Real> sum_;
};

/// Runs of the contacts of one region. Memory is reused for the next region.
class ContactRuns {
public:
    /// A run: the contacts from `begin` up to, but not including `end`, and in the same way the patches from
    /// `first_patch` to `last_patch`. A patch lists the nodes of these contacts that are on one body.
    struct Run {
        Index begin, end;
        std::size_t first_patch, last_patch;
    };

    /// Begins another region, whose runs are not listed yet.
    void start() { run_.clear(); }
    bool listed() const { return !run_.empty(); }
    /// Lists the runs. `most_nodes`: upper limit of the number of nodes per run. A small limit spreads impulses to all
    /// nodes more often; a large limit moves more nodes at each contact.
    void list(std::span<const LumpedContact> contact, const ThroughGroups& traversal, std::size_t rows,
              std::size_t most_nodes = 24);
    std::span<const Run> runs() const { return run_; }
    /// Applies an impulse of contact `i` to the nodes of its run. The caller applies it to rigid bodies.
    void apply(std::size_t i, const LumpedContact& contact, const ThroughGroups& traversal, const Vec4& impulse,
               Vec4* velocity);
    /// Applies the summed impulses of a run to the touched nodes outside of the run. Call it at the end of the run.
    void spread(const Run& run, const ThroughGroups& traversal, Vec4* velocity);
    /// Number of node velocities that a sweep updates, counting repeated updates; for the estimate of its cost.
    Real moved() const { return moved_; }

    /// Returns zeroed impulse sums by velocity row of the region, for impulses that belong to no run: those of cables,
    /// and those outside of sweeps [N s]
    std::span<Vec4> sums(std::size_t rows) {
        sum_.assign(rows, Vec4::Zero());
        return sum_;
    }
    /// Applies the impulses in sums() to the implicit bodies.
    void spread_sums(const ThroughGroups& traversal, Vec4* velocity);

private:
    /// Nodes of one body in the contacts of a run: `count` entries of node_ from `first` on. Their response blocks
    /// begin at `first_block` in block_.
    struct Patch {
        std::size_t first, count, first_block;
        std::size_t body;  // row of RigidBodyTable
        Index first_row;   // the body's first touched node: its row in the list of all nodes of the region
    };
    /// Nodes of the run that move when an impulse acts on one node of a contact. `count` is 0 if this node is on no
    /// implicit body.
    struct MovedNodes {
        // `first`: index in node_ of the first of `count` moved nodes. `self`: index in node_ of the node on which the
        // impulse acts. `row`: index in block_ of the first of `count` blocks, the responses of the moved nodes to the
        // impulse.
        std::size_t first, count, self, row;
    };

    void list_patches(std::span<const LumpedContact> contact, const ThroughGroups& traversal, std::size_t first_node,
                      Run& run);
    void add_blocks(const ThroughGroups& traversal, const Patch& patch);

    Column<Run> run_;
    Column<Patch> patch_;
    Column<Index> node_;                             // rows in the region's list of nodes, ascending within a patch
    Column<Vec4> pending_;                           // impulse sum by index in node_ [N s]
    Column<std::array<MovedNodes, 4>> moved_nodes_;  // by contact
    Column<PaddedMat3> block_;  // responses of node velocities to impulses on nodes, in world axes [1/kg]
    // For each row in the region's list of nodes: index in node_ at which the row was stored last. The index is
    // outdated if node_ now holds another row there.
    Column<Index> node_index_;
    Column<Vec4> sum_;
    SpreadImpulses impulses_;
    Real moved_ = 0;
};

}  // namespace skerry
