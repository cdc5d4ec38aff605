// Bounding volume hierarchies for ray casts and searches of nearest points.
#pragma once

#include "engine/world/world_state.h"
#include "systems/collision/query/surface_query.h"

namespace skerry {

/// Returns the bounding volume hierarchy of a body or a mesh collider, fitted to the present positions of its nodes.
/// The fitted boxes are reused until QueryTrees::forget() is called. `body`: row of BodyTable.
SurfaceTree fitted_tree(WorldState& world, std::size_t body);

}  // namespace skerry
