#include "systems/collision/narrow/candidate_lanes.h"

#include "systems/geometry/closest_lanes.h"

namespace skerry {

namespace {

using NodeRows = std::array<Index, candidate_lanes>;

[[gnu::always_inline]] inline LaneVec3<Real8> gather(std::span<const Vec3> of_node, const NodeRows& node) {
    const auto axis = [&](Index i) {
        const auto at = [&](std::size_t l) { return of_node[static_cast<std::size_t>(node[l])][i]; };
        return Real8{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)};
    };
    return {axis(0), axis(1), axis(2)};
}

[[gnu::always_inline]] inline Real8 squared_difference(const LaneVec3<Real8>& a, const LaneVec3<Real8>& b) {
    const LaneVec3<Real8> d = a - b;
    return dot(d, d);
}

/// b where a is not a number.
[[gnu::always_inline]] inline Real8 greater(const Real8& a, const Real8& b) {
    return a > b ? a : b;
}

struct PointNodes {
    NodeRows point;
    std::array<NodeRows, 3> corner;

    PointNodes(const CollisionInputs& inputs, std::span<const Candidate> candidates, const CandidateRows& row) {
        for (std::size_t l = 0; l < candidate_lanes; ++l) {
            const Candidate& candidate = candidates[static_cast<std::size_t>(row[l])];
            point[l] = inputs.surface.vertices.node[candidate.first];
            const std::array<Index, 3>& node = inputs.surface.triangles.node[candidate.second];
            for (std::size_t k = 0; k < 3; ++k) corner[k][l] = node[k];
        }
    }
};

struct EdgeNodes {
    std::array<NodeRows, 2> first, second;

    EdgeNodes(const CollisionInputs& inputs, std::span<const Candidate> candidates, const CandidateRows& row) {
        for (std::size_t l = 0; l < candidate_lanes; ++l) {
            const Candidate& candidate = candidates[static_cast<std::size_t>(row[l])];
            const std::array<Index, 2>&a = inputs.surface.edges.node[candidate.first],
                                    &b = inputs.surface.edges.node[candidate.second];
            for (std::size_t k = 0; k < 2; ++k) {
                first[k][l] = a[k];
                second[k][l] = b[k];
            }
        }
    }
};

[[gnu::always_inline]] inline LaneVec3<Real8> gather(const StepMotion& motion, const NodeRows& node) {
    return motion.h * (gather(motion.velocity_next, node) + gather(motion.push_out, node));
}

[[gnu::always_inline]] inline LaneVec3<Real8> mean_of(const std::array<LaneVec3<Real8>, 4>& v) {
    return Real(0.25) * (v[0] + v[1] + v[2] + v[3]);
}

}  // namespace

CandidateDistances point_triangle_distances(const CollisionInputs& inputs, std::span<const Candidate> candidates,
                                            const CandidateRows& row) {
    const PointNodes node(inputs, candidates, row);
    CandidateDistances out;
    store(square_root(
              point_triangle_distance(gather(inputs.position, node.point), gather(inputs.position, node.corner[0]),
                                      gather(inputs.position, node.corner[1]), gather(inputs.position, node.corner[2]))
                  .distance_squared),
          out.distance);
    const LaneVec3<Real8> own = gather(inputs.velocity, node.point);
    Real8 speed_squared = squared_difference(own, gather(inputs.velocity, node.corner[0]));
    for (std::size_t k = 1; k < 3; ++k)
        speed_squared = greater(squared_difference(own, gather(inputs.velocity, node.corner[k])), speed_squared);
    store(square_root(speed_squared), out.speed);
    return out;
}

CandidateDistances edge_edge_distances(const CollisionInputs& inputs, std::span<const Candidate> candidates,
                                       const CandidateRows& row) {
    const EdgeNodes node(inputs, candidates, row);
    CandidateDistances out;
    store(square_root(segment_distance_squared(
              gather(inputs.position, node.first[0]), gather(inputs.position, node.first[1]),
              gather(inputs.position, node.second[0]), gather(inputs.position, node.second[1]))),
          out.distance);
    const LaneVec3<Real8> a0 = gather(inputs.velocity, node.first[0]), a1 = gather(inputs.velocity, node.first[1]);
    const LaneVec3<Real8> b0 = gather(inputs.velocity, node.second[0]), b1 = gather(inputs.velocity, node.second[1]);
    store(square_root(greater(greater(squared_difference(a0, b0), squared_difference(a0, b1)),
                              greater(squared_difference(a1, b0), squared_difference(a1, b1)))),
          out.speed);
    return out;
}

Lanes<Real, candidate_lanes> point_triangle_approaches(const CollisionInputs& inputs, const StepMotion& motion,
                                                       std::span<const Candidate> candidates,
                                                       const CandidateRows& row) {
    const PointNodes node(inputs, candidates, row);
    const std::array<LaneVec3<Real8>, 4> moved{gather(motion, node.point), gather(motion, node.corner[0]),
                                               gather(motion, node.corner[1]), gather(motion, node.corner[2])};
    const LaneVec3<Real8> mean = mean_of(moved);
    Lanes<Real, candidate_lanes> approach;
    store(square_root(squared_difference(moved[0], mean)) +
              square_root(greater(greater(squared_difference(moved[1], mean), squared_difference(moved[2], mean)),
                                  squared_difference(moved[3], mean))),
          approach);
    return approach;
}

Lanes<Real, candidate_lanes> edge_edge_approaches(const CollisionInputs& inputs, const StepMotion& motion,
                                                  std::span<const Candidate> candidates, const CandidateRows& row) {
    const EdgeNodes node(inputs, candidates, row);
    const std::array<LaneVec3<Real8>, 4> moved{gather(motion, node.first[0]), gather(motion, node.first[1]),
                                               gather(motion, node.second[0]), gather(motion, node.second[1])};
    const LaneVec3<Real8> mean = mean_of(moved);
    Lanes<Real, candidate_lanes> approach;
    store(square_root(greater(squared_difference(moved[0], mean), squared_difference(moved[1], mean))) +
              square_root(greater(squared_difference(moved[2], mean), squared_difference(moved[3], mean))),
          approach);
    return approach;
}

}  // namespace skerry
