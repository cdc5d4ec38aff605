// One hash of all data on which the next step depends.
#pragma once

#include <cstdint>

#include "engine/world/world_state.h"

namespace skerry {

/// Returns one hash of all columns with the role `state` or `link` (ColumnRole), of the clock and of gravity. It serves
/// to test whether two worlds have equal states. The hash does not depend on
/// - the rows in which tables store an object: objects are hashed in the order of the slots of their handles, and row
///   numbers of nodes and elements are counted from the first row of the body;
/// - stored pairs of objects that do not overlap: a search finds them again;
/// - settings that cannot change later: worlds with different numbers of threads can be compared.
std::uint64_t state_hash(WorldState& world);

/// Returns the hash of one body with its nodes and elements. `body`: row of BodyTable.
std::uint64_t body_hash(Model& model, std::size_t body);

}  // namespace skerry
