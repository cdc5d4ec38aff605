// Contact data of bodies that move between ranks.
#pragma once

#include <span>

#include "engine/world/edit/row_moves.h"
#include "engine/world/ranks/rows/body_rows.h"

namespace skerry {

/// Copies the contact data of all pairs for which `wants` is true. The copies name bodies by their rows in the
/// undivided world.
void copy_contacts(WorldState& world, const WantsPair& wants, BodyRows& to);

/// Removes the contact data of removed bodies and of pairs for which `keeps` is false, and renumbers all other data.
/// `body_of_node`: body row of each node before the rows are moved.
void keep_contacts(const RowMoves& moves, std::span<const Index> body_of_node, const WantsPair& keeps,
                   WorldState& world);

/// Adds contact data that came with bodies. Tables stay in the order of their keys.
void add_contacts(std::span<BodyRows> added, WorldState& world);

}  // namespace skerry
