// Choice of the ranks that own bodies.
#pragma once

#include <cstdint>
#include <span>

#include "components/bvh_table.h"
#include "engine/world/ranks/hold/whole_world.h"
#include "skerry/ranks.h"

namespace skerry {

/// Properties of a body that decide which ranks own and hold it. Ranks send them to each other.
struct BodyExtent {
    Index place;
    Real cost;    // computing time of a step, in units of that of an explicit element
    Real margin;  // distance by which the body may move inside the box [m]
    Aabb box;     // [m]
    bool on_all;  // true if all ranks must hold the body
};

/// Chooses an owner for each body, the same one for all bodies of a unit. `extents`: all bodies that can move, in the
/// order of their rows in the undivided world. Returns the owner for each row of the undivided world.
Column<std::int32_t> choose_owners(const WholeWorld& whole, std::span<const BodyExtent> extents,
                                   const RankSettings& settings, int rank_count);

/// Greatest cost of a rank divided by the mean cost.
Real imbalance(std::span<const std::int32_t> owner, std::span<const BodyExtent> extents, int rank_count);

/// For each row of the undivided world, the ranks that hold its body, ascending: the ranks that own a body of its unit,
/// or a body whose box overlaps the box of a body of its unit. `owner`: by row of the undivided world.
std::vector<std::vector<int>> find_holders(const WholeWorld& whole, std::span<const std::int32_t> owner,
                                           std::span<const BodyExtent> extents, int rank_count);

}  // namespace skerry
