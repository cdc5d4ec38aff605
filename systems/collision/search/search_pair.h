// Features of one pair that are near each other.
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
    Real travel_base;  // m, pair_travel_base of both
    Real margin;       // m: features nearer than scale.zone + margin are listed
    Real apart;        // m, a lower bound of the distance of two bodies
};

/// Lists the near features of a pair in feature order, each once: points against triangles both ways and edges against
/// edges (by two trees whose boxes fit the present positions), or against a collider (search_collider). In a body's
/// pair with itself features that share a node are left out, and those that are nearer than the contact distance at
/// rest. Returns until which travel_bound the list is complete.
Real search_pair(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box,
                 Column<FoundCandidate>& found);

}  // namespace skerry
