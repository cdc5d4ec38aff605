#include "systems/collision/narrow/candidate_lanes.h"

#include "systems/geometry/closest_lanes.h"

namespace skerry {

namespace {

using NodeLanes = std::array<Index, candidate_lanes>;

[[gnu::always_inline]] inline LaneVec3<Real8> gather(std::span<const Vec3> of_node, const NodeLanes& node) {
    const auto axis = [&](Index i) {
        const auto at = [&](std::size_t l) { return of_node[static_cast<std::size_t>(node[l])][i]; };
        return Real8{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)};
    };
    return {axis(0), axis(1), axis(2)};
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
    const LaneVec3<Real8> a = gather(position, node[0]), b = gather(position, node[1]), c = gather(position, node[2]),
                          d = gather(position, node[3]);
    Lanes<Real, candidate_lanes> distance;
    if (kind == FeaturePair::edge_edge)
        store(square_root(segment_distance_squared(a, b, c, d)), distance);
    else
        store(square_root(point_triangle_distance(a, b, c, d).distance_squared), distance);
    return distance;
}

}  // namespace skerry
