// Search for features of one pair that are near each other.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_reach.h"

namespace skerry {

struct PairToSearch {
    PairKind kind;
    Index first;
    Index second;
    PairScale scale;
    Real travel_base;  // travel from which the bounds of this pair are counted (pair_travel_base) [m]
    Real margin;       // features nearer than scale.zone + margin are listed [m]
    Real apart;        // lower bound of the distance between two bodies [m]
};

/// Lists the near features of a pair in feature order, each pair of features once. For two bodies these are points and
/// triangles of either body, and pairs of edges. They are found with two trees, whose boxes must fit the present
/// positions. For a body and a collider, it calls search_collider. If a body is paired with itself, features are left
/// out that share a node or that are nearer in the rest shape than the contact distance. Returns the travel_bound up to
/// which the list is complete [m].
Real search_pair(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box,
                 Column<FoundCandidate>& found);

/// Lists in feature order the nodes and edges of a body that are near a part of a collider, and the faces that are near
/// a point of the collider. Edges and faces are listed only if they may touch between their nodes. Returns the
/// travel_bound up to which the list is complete [m].
Real search_collider(const CollisionInputs& inputs, const PairToSearch& pair, Column<FoundCandidate>& found);

/// True if an edge of one surface passes through a triangle of the other. It traverses two trees, whose boxes must fit
/// the present positions. Surfaces that only touch do not cross. If a body is paired with itself, features that are
/// near each other in the rest shape do not count.
bool surfaces_cross(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box);

}  // namespace skerry
