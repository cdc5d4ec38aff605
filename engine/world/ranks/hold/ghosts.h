// Owners and holders of the bodies of a divided world, and the transfer of bodies between ranks. The holders of a body
// are the ranks that own it or have a copy (ghost) of it.
#pragma once

#include <span>
#include <vector>

#include "engine/world/ranks/hold/owners.h"
#include "engine/world/world_state.h"
#include "jobs/task_graph.h"

namespace skerry {

/// Costs and boxes of marked bodies, in the order of their rows in the undivided world. `marked`: by row of BodyTable.
std::vector<BodyExtent> extents_of(const WorldState& world, std::span<const std::uint8_t> marked);

/// Sets the columns of RankState that follow from the owners and holders of all bodies. `extents`: boxes and margins of
/// the bodies, from which find_holders has found the holders.
void note_holders(RankState& ranks, std::span<const BodyExtent> extents);

/// Lists the stage that tests whether holders must be found again: a body may leave its BodyExtent::box in this step,
/// or the last search was too many steps ago (RankFindings::ghosts_expired). Lists nothing if this process simulates
/// the whole world.
void list_ghost_watch(WorldState& world, TaskGraph& graph);
/// Lists the stage that measures how far bodies have moved since their holders were found.
void list_ghost_paths(WorldState& world, TaskGraph& graph);

/// Rank search. Collective: all ranks must call it, between attempts at a step. Finds the ranks that must hold each
/// body, from the present positions and from RankState::requests, and sends bodies to them. With OwnerMap::curve,
/// bodies get new owners if the costs of the ranks differ too much. Changes no state of any body.
void update_ghosts(WorldState& world);
/// Like update_ghosts, but with given owners. `owner`: by row of the undivided world.
void move_to_owners(WorldState& world, const Column<std::int32_t>& owner);

}  // namespace skerry
