// Cables: one row per cable, the points through which the cables run, and the equations of cables in a step
// (docs/methods/cables.md).
#pragma once

#include <cstdint>
#include <span>

#include "components/anchor.h"
#include "components/cable_control.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/contact_table.h"
#include "components/key_lists.h"
#include "components/range.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

template <>
inline constexpr std::uint64_t value_count<CableControl> = 3;

/// One row per cable. Segment `s` of a cable is the straight line from its point `s` to its next point.
struct CableTable {
    Column<std::uint32_t> slot;
    Column<CableControl> control;
    Column<Real> friction;  // friction coefficient at the points between the first and the last
    // upper limit of the length of the cable at the end of the last step [m]; with the control `rate`, each step adds
    // rate times step length to it
    Column<Real> released;
    Column<Real> step;        // time for which the tensions acted in the last step; 0 before the first step [s]
    Column<Real> work;        // work of the prescribed tension or length up to the start of the last step [J]
    Column<Real> dissipated;  // energy that friction at the points dissipated up to the start of the last step [J]
    Column<Range> points;     // rows of the columns that have one row per point
    Column<Range> keys;       // rows of `key`
    // The following columns have one row per point. For the last point of a cable, `tension` and `length` are 0.
    AnchorColumns anchor;
    Column<Real> tension;  // impulse of the tension of the segment from this point to the next in the last step [N s]
    Column<Real> length;   // length of the segment from this point to the next at the start of the last step [m]
    Column<TimeKey> key;   // prescribed values of all cables

    std::size_t size() const { return slot.size(); }

    std::span<const TimeKey> keys_of(std::size_t cable) const { return rows_of(key.span(), keys[cable]); }
    /// Rows of the cable in the columns with one row per point.
    Range list_of(std::size_t cable) const { return points[cable]; }
    /// Erases the keys and the points of a cable.
    void erase_keys_of(std::size_t cable) {
        erase_keys(keys, key, cable);
        const Range erased = points[cable];
        for (Range& other : points.span())
            if (other.begin >= erased.end) other = {other.begin - erased.size(), other.end - erased.size()};
        points[cable] = {};
        if (erased.size() == 0) return;
        const std::span<const Range> ranges(&erased, 1);
        anchor.body.erase(ranges);
        anchor.collider.erase(ranges);
        anchor.point.erase(ranges);
        tension.erase(ranges);
        length.erase(ranges);
    }

    /// Visits the columns with one row per cable.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("control", control, ColumnRole::state);
        visit("friction", friction, ColumnRole::state);
        visit("released", released, ColumnRole::state);
        visit("step", step, ColumnRole::state);
        visit("work", work, ColumnRole::state);
        visit("dissipated", dissipated, ColumnRole::state);
        visit("points", points, ColumnRole::link);
        visit("keys", keys, ColumnRole::link);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        anchor.for_each_column({"body", "collider", "anchor"}, visit);
        visit("tension", tension, ColumnRole::state);
        visit("length", length, ColumnRole::state);
        visit("key", key, ColumnRole::state);
    }
};

/// Equations of a cable, or of a tie of the kind `ball` (TieKind), in a step. Unlike a contact, a block has any number
/// of points.
/// - cable: one impulse for each segment; its tension pulls both ends of the segment together
/// - tie: one impulse vector, which acts on all points; the sum of the velocities of the points, weighted by their
///   stencils, is zero
struct CableBlock {
    Index cable;   // row of CableTable; for a tie, row of TieTable
    Range points;  // rows of those columns of CableBlockTable that have one row per point
    // True: the impulses are unknowns of a contact region. False: the tensions are known before the solve.
    bool solved;
    bool by_length;  // true: an upper limit of the length is prescribed; false: the tension of the first segment
    // If by_length: upper limit of the rate of the length [m/s]. Otherwise: impulse of the tension of the first segment
    // [N s].
    Real prescribed;
    Real released;  // upper limit of the length at the end of the step [m]
    // Index of the first entry of the block's mobility matrix, which gives the velocities that unit impulses of the
    // block cause. The region solver stores the mobility matrices of all blocks one after the other in one array.
    Index mobility;
    bool is_tie = false;
    // For a tie: position at which its impulse acts on the object that the nodes are tied to [m]. The last point of the
    // block belongs to this object.
    Vec3 acts_at = Vec3::Zero();

    /// Number of impulses of the block: one per segment of a cable, or the three components of the impulse of a tie.
    /// Row points.begin + i of CableBlockTable::impulse stores impulse i.
    Index impulses() const { return is_tie ? 3 : points.size() - 1; }
    /// Position at which the impulse of point `p` acts on rigid and implicit bodies. Returns nullptr if the impulse
    /// acts at the nodes of the point.
    const Vec3* acting_point(Index p) const { return is_tie && p + 1 == points.end ? &acts_at : nullptr; }
};

/// Blocks of a step: first cables with known forces, then solved cables, then ties of the kind `ball`. A cable or tie
/// is left out if all its bodies sleep, or if its impulses cannot move any node.
struct CableBlockTable {
    Column<CableBlock> block;
    // The following columns have one row per point, except those marked `by block`.
    Column<Stencil> stencil;  // nodes and weights; all weights are 0 for points of colliders and of the world
    // Velocity that is added to the weighted sum of the velocities of the point's nodes. Point on a collider: the
    // velocity of this point. Last point of a tie: minus the velocity that the tie prescribes. Other points: 0 [m/s].
    Column<Vec3> velocity;
    Column<Vec3> direction;  // unit vector to the next point; 0 at the last point
    Column<Real> length;     // distance to the next point; 0 at the last point [m]
    // greatest ratio of the tensions on both sides of the point, from the capstan equation: exp(friction coefficient
    // times angle of the bend [rad])
    Column<Real> most_ratio;
    Column<Real> impulse;      // impulses of the block (CableBlock::impulses); before the solve: the warm start [N s]
    Column<Real> work;         // by block: work of a solved cable on the bodies [J]
    Column<Real> dissipated;   // by block: energy that friction at the points of a solved cable dissipates [J]
    Column<Vec3> sum_impulse;  // by block: total impulse of a solved cable on the moving nodes [N s]
    Index mobilities = 0;      // number of entries of all mobility matrices
    Index first_solved = 0;    // row of the first block with `solved` set; `solved` is set in all later blocks

    std::span<const CableBlock> solved() const { return block.span().subspan(static_cast<std::size_t>(first_solved)); }
    void for_each_column(auto&& visit) {
        visit("block", block, ColumnRole::scratch);
        visit("stencil", stencil, ColumnRole::scratch);
        visit("velocity", velocity, ColumnRole::scratch);
        visit("direction", direction, ColumnRole::scratch);
        visit("length", length, ColumnRole::scratch);
        visit("most_ratio", most_ratio, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("work", work, ColumnRole::scratch);
        visit("dissipated", dissipated, ColumnRole::scratch);
        visit("sum_impulse", sum_impulse, ColumnRole::scratch);
    }
};

}  // namespace skerry
