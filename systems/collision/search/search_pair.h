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
    Real travel_base;  // pair_travel_base of both [m]
    Real margin;       // features nearer than scale.zone + margin are listed [m]
    Real apart;        // lower bound of the distance of two bodies [m]
};

/// Lists the near features of a pair in feature order, each once: points against triangles both ways and edges against
/// edges (by two trees whose boxes fit the present positions), or against a collider (search_collider). If a body is
/// paired with itself, features that share a node, or are nearer than the contact distance at rest, are left out.
/// Returns the travel_bound up to which the list is complete [m].
Real search_pair(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box,
                 Column<FoundCandidate>& found);

/// Lists in feature order the nodes of a body that are near a part of a collider, the faces that are near one of its
/// points and the edges that are near a part. Faces and edges are listed only where they may touch between their nodes.
/// Returns the travel_bound up to which the list is complete [m].
Real search_collider(const CollisionInputs& inputs, const PairToSearch& pair, Column<FoundCandidate>& found);

/// True if an edge of one surface passes through a triangle of the other. It traverses two trees whose boxes fit the
/// present positions. Touching does not count. If a body is paired with itself, features that were near each other at
/// rest do not count either.
bool surfaces_cross(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box);

}  // namespace skerry
