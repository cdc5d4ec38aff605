// Distances of eight pairs of features at a time. They show which pairs of features must be tested more closely.
#pragma once

#include <array>
#include <span>

#include "components/lanes.h"
#include "components/pair_table.h"
#include "components/surface_table.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

inline constexpr std::size_t candidate_lanes = element_lanes;

/// Nodes of a candidate: the point and the three corners of the triangle, or the two ends of the first edge and the two
/// ends of the second edge.
using CandidateNodes = std::array<Index, 4>;

/// Nodes of eight candidates, in the order of CandidateNodes: node[i][lane].
using CandidateNodeLanes = std::array<std::array<Index, candidate_lanes>, 4>;

inline void set_lane(CandidateNodeLanes& lanes, std::size_t lane, const CandidateNodes& node) {
    for (std::size_t i = 0; i < node.size(); ++i) lanes[i][lane] = node[i];
}

/// Kind of the two features of a candidate between two surfaces.
inline FeaturePair features_of(const Candidate& candidate) {
    return is_edge_edge(candidate.feature) ? FeaturePair::edge_edge : FeaturePair::point_triangle;
}
void prefetch_nodes(const SurfaceTables& surface, const Candidate& candidate);
CandidateNodes nodes_of(const SurfaceTables& surface, const Candidate& candidate);

/// Distances between the two features of each of eight candidates [m]. A distance is NaN if a coordinate is NaN.
Lanes<Real, candidate_lanes> distances(FeaturePair kind, std::span<const Vec3> position,
                                       const CandidateNodeLanes& node);

}  // namespace skerry
