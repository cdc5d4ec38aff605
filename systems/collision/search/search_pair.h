// Search for features of one pair that are close to each other.
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
    // Features that are now at the distance d cannot meet while PairTable::travel_bound is below travel_base + d
    // (pair_travel_base) [m].
    Real travel_base;
    Real margin;        // features with a distance below scale.zone + margin are listed [m]
    Real min_distance;  // lower bound of the distance between the two bodies [m]
    // For a body paired with itself: the pairs of leaves to compare. LeafPair::spare is used in place of `margin`.
    std::span<const LeafPair> leaf_pairs{};
};

/// Lists the close features of a pair of bodies in feature order: points of either body with triangles of the other,
/// and edges with edges, each combination once. Returns the travel of the pair up to which the list is complete
/// (PairTable::travel_bound) [m]. Uses the trees of both bodies, whose boxes must be computed from the present
/// positions.
///
/// If a body is paired with itself, only the features of leaf_pairs are compared. Features that share a node, or whose
/// distance in the rest shape is below the contact distance, are left out.
Real search_pair(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box,
                 Column<FoundCandidate>& found);

/// Lists the nodes and edges of a body that are close to a part of a collider, and the faces that are close to a point
/// of the collider (collider_point). The list is in feature order. Edges and faces are listed only if their interior
/// may touch. Returns the travel of the pair up to which the list is complete (PairTable::travel_bound) [m].
Real search_collider(const CollisionInputs& inputs, const PairToSearch& pair, Column<FoundCandidate>& found);

/// True if an edge of one surface passes through a triangle of the other surface. Surfaces that only touch do not
/// cross. The boxes of both trees must be computed from the present positions. In a body that is paired with itself,
/// features whose distance in the rest shape is at most half of the mean edge do not count.
bool surfaces_cross(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box);

/// Counts the pairs of an edge and a triangle of one body whose edge passes through the triangle. Features whose
/// distance in the rest shape is at most the mean edge do not count. The boxes of the tree must be computed from the
/// present positions.
Index count_self_crossings(const CollisionInputs& inputs, Index body, std::span<const Aabb> box);

}  // namespace skerry
