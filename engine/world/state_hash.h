// One hash of all state that the next step depends on.
#pragma once

#include <cstdint>

#include "engine/world/world_state.h"

namespace skerry {

/// Returns the hash of every column with the role `state` or `link` (ColumnRole), of the clock and of gravity.
///
/// Bodies are hashed one by one, in the order of their slots. Row numbers of nodes and elements are counted from the
/// first row of the body. Materials, colliders, attachments and joints are hashed in the order of their slots too. So
/// the hash does not depend on the rows in which the tables store an object. Of the stored pairs of objects only
/// overlapping ones are hashed, because a search finds all others again. Settings that cannot change later are not
/// hashed, so that worlds with different numbers of threads can be compared.
std::uint64_t state_hash(WorldState& world);

/// Returns the hash of one body with its nodes and elements. `body`: row of BodyTable.
std::uint64_t body_hash(Model& model, std::size_t body);

}  // namespace skerry
