// Sweeps over contacts on bodies that deform: an impulse on a node moves all touched nodes of its body, but only those
// that the next contacts name have to move at once (docs/methods/implicit_bodies.md 4). Runs are consecutive contacts
// that name few nodes. What the contacts of a run do to other nodes is summed up by node, and done when the run is
// over: the same sweep, to rounding.
#pragma once

#include <array>
#include <span>

#include "components/column.h"
#include "components/implicit_coupling.h"
#include "systems/solver/local/lumped_contact.h"
#include "systems/solver/operators/through_groups.h"

namespace skerry {

using PaddedMat3 = Eigen::Matrix<Real, 4, 3>;  // the fourth row is zero

/// Impulses on touched nodes of one body, and what they do to all of them together.
class SpreadImpulses {
public:
    SpreadImpulses() = default;
    void start() {
        column_.clear();
        factor_.clear();
    }
    void add(const ImplicitCoupling& coupling, std::size_t body, Index place, const Vec4& impulse);
    bool empty() const { return factor_.empty(); }
    /// By number of the touched nodes, m/s in the frame of the mesh.
    std::span<const Real> velocities(std::size_t numbers);

private:
    Column<const Real*> column_;  // of ImplicitCoupling::response
    Column<Real> factor_;         // N s
    Column<Real> sum_;
};

/// Keeps its memory. Of one region at a time.
class ContactRuns {
public:
    /// Consecutive contacts, and which patches they touch.
    struct Run {
        Index begin, end;
        std::size_t first_patch, last_patch;
    };

    /// Of another region: nothing is listed.
    void start() { run_.clear(); }
    bool listed() const { return !run_.empty(); }
    /// `most_nodes`: of a run. Fewer are spread more often, more move each other more often.
    void list(std::span<const LumpedContact> contact, const ThroughGroups& walk, std::size_t rows,
              std::size_t most_nodes = 24);
    std::span<const Run> runs() const { return run_; }
    /// An impulse of contact `i` in its run, but for rigid bodies.
    void apply(std::size_t i, const LumpedContact& contact, const ThroughGroups& walk, const Vec4& impulse,
               Vec4* velocity);
    /// At the end of a run.
    void spread(const Run& run, const ThroughGroups& walk, Vec4* velocity);
    /// Velocities that a sweep moves, with those that it moves several times.
    Real moved() const { return moved_; }

    /// By node of the region, zero: for impulses that are not those of a sweep.
    std::span<Vec4> sums(std::size_t rows) {
        sum_.assign(rows, Vec4::Zero());
        return sum_;
    }
    /// What these do to bodies that deform.
    void spread_sums(const ThroughGroups& walk, Vec4* velocity);

private:
    /// The nodes of one body that the contacts of a run name: `count` of node_ from `first`, with their blocks of W.
    struct Patch {
        std::size_t first, count, first_block;
        std::size_t body;  // RigidBodyTable
        Index first_row;   // of the region, of the touched nodes of the body
    };
    /// Of a node of a contact: what it moves in its run; no `count` where it deforms no body.
    struct Near {
        std::size_t first, count, self, row;  // in node_; `row`: in block_
    };

    void list_patches(std::span<const LumpedContact> contact, const ThroughGroups& walk, std::size_t first_node,
                      Run& run);
    void add_blocks(const ThroughGroups& walk, const Patch& patch);

    Column<Run> run_;
    Column<Patch> patch_;
    Column<Index> node_;                // rows of the region, ascending in a patch
    Column<Vec4> pending_;              // N s, by node_
    Column<std::array<Near, 4>> near_;  // by contact
    Column<PaddedMat3> block_;          // 1/kg, world
    Column<Index> entry_;               // by row of the region: in node_, if that agrees
    Column<Vec4> sum_;
    SpreadImpulses impulses_;
    Real moved_ = 0;
};

}  // namespace skerry
