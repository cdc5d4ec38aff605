// Eight pairs of features at a time: which of them are worth a closer look.
#pragma once

#include <array>
#include <span>

#include "components/lanes.h"
#include "components/pair_table.h"
#include "components/surface_table.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/inputs/step_motion.h"
#include "systems/geometry/time_of_contact.h"

namespace skerry {

inline constexpr std::size_t candidate_lanes = element_lanes;

/// Of points and triangles the point and the three corners, of edges and edges the ends of the first and of the second.
using CandidateNodes = std::array<Index, 4>;

/// The same of eight.
using CandidateNodeLanes = std::array<std::array<Index, candidate_lanes>, 4>;

inline void set_lane(CandidateNodeLanes& lanes, std::size_t lane, const CandidateNodes& node) {
    for (std::size_t i = 0; i < node.size(); ++i) lanes[i][lane] = node[i];
}

/// Of two bodies.
inline FeaturePair features_of(const Candidate& candidate) {
    return is_edge_edge(candidate.feature) ? FeaturePair::edge_edge : FeaturePair::point_triangle;
}
CandidateNodes nodes_of(const SurfaceTables& surface, const Candidate& candidate);

/// m; not a number where a position is none.
Lanes<Real, candidate_lanes> distances(FeaturePair kind, std::span<const Vec3> position,
                                       const CandidateNodeLanes& node);

/// m/s, the greatest difference of two velocities, one of each feature.
Lanes<Real, candidate_lanes> relative_speeds(FeaturePair kind, std::span<const Vec3> velocity,
                                             const CandidateNodeLanes& node);

/// m, greatest_approach of each while every node moves by h (velocity_next + push_out).
Lanes<Real, candidate_lanes> approaches(FeaturePair kind, const StepMotion& motion, const CandidateNodeLanes& node);

}  // namespace skerry
