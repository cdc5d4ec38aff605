// Search for features of a body that are near an analytic collider.
#pragma once

#include "systems/collision/search/search_pair.h"

namespace skerry {

/// Lists in feature order the nodes of a body that are near a part of a collider, the faces that are near one of its
/// points and the edges that are near a part. Faces and edges are listed only where they may touch between their nodes.
/// Returns the travel_bound up to which the list is complete [m].
Real search_collider(const CollisionInputs& inputs, const PairToSearch& pair, Column<FoundCandidate>& found);

}  // namespace skerry
