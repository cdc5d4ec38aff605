// Bounding volume hierarchies for queries.
#pragma once

#include "engine/world/world_state.h"
#include "systems/collision/query/surface_query.h"

namespace skerry {

/// Returns the bounding volume hierarchy of a body or a mesh collider, fitted to the present positions of its nodes. It
/// is fitted once, until QueryTrees::forget(). `body`: row of BodyTable.
SurfaceTree fitted_tree(WorldState& world, std::size_t body);

}  // namespace skerry
