// Choice of the ranks that own bodies.
#pragma once

#include <cstdint>
#include <span>

#include "components/bvh_table.h"
#include "engine/world/ranks/hold/whole_world.h"
#include "skerry/ranks.h"

namespace skerry {

/// Properties of a body that decide which ranks own and hold the body. Ranks send these properties to each other.
struct BodyExtent {
    Index world_row;
    Real cost;    // time per step, in units of the time for an explicit element
    Real margin;  // distance by which the body may move inside the box [m]
    Aabb box;     // [m]
    bool on_all;  // true if all ranks must hold the body
};

/// Chooses the rank that owns each body. All bodies of a unit, which is a set of bodies that joints or similar rows
/// connect (WholeWorld::unit), get the same owner. `extents`: all bodies that can move, in the order of their rows in
/// the undivided world. Returns the owner for each row of the undivided world.
Column<std::int32_t> choose_owners(const WholeWorld& whole, std::span<const BodyExtent> extents,
                                   const RankSettings& settings, int rank_count);

/// Greatest cost of a rank divided by the mean cost of the ranks. `owner`: by row of the undivided world.
Real imbalance(std::span<const std::int32_t> owner, std::span<const BodyExtent> extents, int rank_count);

/// Returns a list of ranks for each body. It contains the ranks that hold the body: its owner, and those that have a
/// copy. The ranks of a list are in ascending order. The lists are in the order of the rows of the undivided world, and
/// so are the entries of `owner`.
///
/// All bodies of a unit (bodies that joints or similar rows connect, WholeWorld::unit) are held by the same ranks: by
/// the owner of the unit, and by the owners of all bodies whose boxes overlap the box of a body of the unit. If a body
/// of the unit has `on_all`, all ranks hold the unit.
std::vector<std::vector<int>> find_holding_ranks(const WholeWorld& whole, std::span<const std::int32_t> owner,
                                                 std::span<const BodyExtent> extents, int rank_count);

}  // namespace skerry
