// One hash of all state that the next step depends on.
#pragma once

#include <cstdint>

#include "engine/world/world_state.h"

namespace skerry {

/// Hash of every state and link column (ColumnRole), of the clock and of gravity. Bodies are hashed one by one, with
/// local row numbers, and joined in the order of their slots. So are materials, colliders, attachments and joints. The
/// hash thus does not depend on which rows of the tables they have, or on who had these rows before. Only overlapping
/// pairs count. Settings that cannot change after the world was made are not part of it: it can compare worlds with
/// different numbers of threads.
std::uint64_t state_hash(WorldState& world);

/// Hash of one body (row) alone, with its nodes and elements.
std::uint64_t body_hash(Model& model, std::size_t body);

}  // namespace skerry
