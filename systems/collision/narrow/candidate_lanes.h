// Eight candidates at a time: which of them are worth a closer look.
#pragma once

#include <array>
#include <span>

#include "components/lanes.h"
#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/step_motion.h"

namespace skerry {

inline constexpr std::size_t candidate_lanes = element_lanes;

/// Rows of a list of candidates.
using CandidateRows = std::array<Index, candidate_lanes>;

struct CandidateDistances {
    Lanes<Real, candidate_lanes> distance;  // m; not a number where a position is none
    Lanes<Real, candidate_lanes> speed;     // m/s, the greatest difference of two velocities, one of each feature
};

/// Of points and triangles.
CandidateDistances point_triangle_distances(const CollisionInputs& inputs, std::span<const Candidate> candidates,
                                            const CandidateRows& row);
/// Of edges and edges.
CandidateDistances edge_edge_distances(const CollisionInputs& inputs, std::span<const Candidate> candidates,
                                       const CandidateRows& row);

/// m, greatest_approach of each while every node moves by h (velocity_next + push_out).
Lanes<Real, candidate_lanes> point_triangle_approaches(const CollisionInputs& inputs, const StepMotion& motion,
                                                       std::span<const Candidate> candidates, const CandidateRows& row);
Lanes<Real, candidate_lanes> edge_edge_approaches(const CollisionInputs& inputs, const StepMotion& motion,
                                                  std::span<const Candidate> candidates, const CandidateRows& row);

}  // namespace skerry
