// One number for all that the next step depends on.
#pragma once

#include <cstdint>

#include "engine/world/world_state.h"

namespace skerry {

/// Of every column that is state or link (ColumnRole), of the clock and of gravity. Bodies are hashed one by one, in
/// numbers of their own, and joined in the order of their slots, as are materials, colliders and attachments: which
/// rows of the tables they have, and who had rows before them, does not matter. Of the pairs those that overlap count.
/// Settings that stay as they were when
/// the world was made are not part of it: worlds with different numbers of threads are compared by it.
std::uint64_t state_hash(WorldState& world);

/// Of one body (row) alone, with the nodes and elements it has.
std::uint64_t body_hash(Model& model, std::size_t body);

}  // namespace skerry
