// A world from the state of another.
#pragma once

#include "engine/world/world_state.h"

namespace skerry {

/// Makes `to` go on where `from` stands, bit by bit: copies what is state and rebuilds what is derived from it. `to`
/// keeps its executor, and what it recorded; its settings must be those of `from`, but for threads and backend. The
/// distances that the search of `from` remembers are forgotten by both (ContactCache::forget_distances), so that both
/// search in the same steps from now on. Between calls of advance.
void copy_state(WorldState& from, WorldState& to);

}  // namespace skerry
