// One hash of all state that the next step depends on.
#pragma once

#include <cstdint>

#include "engine/world/world_state.h"

namespace skerry {

/// Returns the hash of every column with the role `state` or `link` (ColumnRole), of the clock and of gravity.
///
/// Bodies are hashed one by one, with local row numbers, in the order of their slots. Materials, colliders, attachments
/// and joints are treated likewise. So the hash does not depend on the rows that these objects have in the tables, nor
/// on earlier objects in these rows. Only overlapping pairs are hashed. Settings that cannot change later
/// are not hashed, so that worlds with different numbers of threads can be compared.
std::uint64_t state_hash(WorldState& world);

/// Returns the hash of one body with its nodes and elements. `body`: row of BodyTable.
std::uint64_t body_hash(Model& model, std::size_t body);

}  // namespace skerry
