#include "systems/collision/narrow/candidate_lanes.h"

#include <utility>

#include "systems/geometry/closest_lanes.h"

namespace skerry {

namespace {

using NodeLanes = std::array<Index, candidate_lanes>;

/// Positions of as many nodes as a register has lanes: the nodes from index part * lanes_of<KernelReal> on [m]. Lane l
/// of the result belongs to the l-th of these nodes.
[[gnu::always_inline]] inline LaneVec3<KernelReal> gather(std::span<const Vec3> position, const NodeLanes& node,
                                                          std::size_t part) {
    const auto axis = [&]<std::size_t... l>(Index i, std::index_sequence<l...>) __attribute__((always_inline)) {
        return KernelReal{position[static_cast<std::size_t>(node[part * lanes_of<KernelReal> + l])][i]...};
    };
    constexpr std::make_index_sequence<lanes_of<KernelReal>> lanes;
    return {axis(0, lanes), axis(1, lanes), axis(2, lanes)};
}

}  // namespace

void prefetch_nodes(const SurfaceTables& surface, const Candidate& candidate) {
    const bool edge = is_edge_edge(candidate.feature);
    __builtin_prefetch(edge ? static_cast<const void*>(&surface.edges.node[candidate.first])
                            : &surface.vertices.node[candidate.first]);
    __builtin_prefetch(edge ? static_cast<const void*>(&surface.edges.node[candidate.second])
                            : &surface.triangles.node[candidate.second]);
}

CandidateNodes nodes_of(const SurfaceTables& surface, const Candidate& candidate) {
    if (is_edge_edge(candidate.feature)) {
        const auto &a = surface.edges.node[candidate.first], &b = surface.edges.node[candidate.second];
        return {a[0], a[1], b[0], b[1]};
    }
    const auto& corner = surface.triangles.node[candidate.second];
    return {surface.vertices.node[candidate.first], corner[0], corner[1], corner[2]};
}

Lanes<Real, candidate_lanes> distances(FeaturePair kind, std::span<const Vec3> position,
                                       const CandidateNodeLanes& node) {
    Lanes<Real, candidate_lanes> distance;
    for (std::size_t part = 0; part < kernel_parts; ++part) {
        const LaneVec3<KernelReal> a = gather(position, node[0], part), b = gather(position, node[1], part),
                                   c = gather(position, node[2], part), d = gather(position, node[3], part);
        const KernelReal squared = kind == FeaturePair::edge_edge
                                       ? segment_distance_squared(a, b, c, d)
                                       : point_triangle_distance(a, b, c, d).distance_squared;
        store_part(square_root(squared), distance, part);
    }
    return distance;
}

}  // namespace skerry
