#include "systems/collision/search/search_pair.h"

#include <cmath>
#include <limits>

#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/tree/leaf_boxes.h"
#include "systems/collision/tree/leaf_pairs.h"
#include "systems/geometry/passes_through.h"

namespace skerry {

namespace {

// Two features of one body are not counted as crossing (count_self_crossings) if their distance at rest was at most
// this multiple of the mean edge. Such near features pass through each other where a few elements are crushed or
// inverted.
constexpr Real own_piece_edges = 1;

class CrossingSearch {
public:
    /// `least_rest_distance`: features of one body that are at most this far apart at rest belong to one piece of the
    /// body and are left out [m].
    CrossingSearch(const CollisionInputs& inputs, PairKind kind, Index first, Index second, Real least_rest_distance,
                   std::span<const Aabb> box)
        : inputs_(inputs),
          kind_(kind),
          first_(first),
          second_(second),
          least_rest_distance_(least_rest_distance),
          box_(box) {}

    /// Calls visit(triangle, side) for each side of a triangle that passes through another triangle, until a call
    /// returns true. Returns true if a call of visit returned true. An edge that two triangles share is visited once
    /// for each of them.
    bool any(auto&& visit) const {
        const Range first = inputs_.body.bvh_nodes[first_], second = inputs_.body.bvh_nodes[second_];
        if (first.size() == 0 || second.size() == 0) return false;
        const bool self = kind_ == PairKind::self;
        return any_leaf_pair(
            inputs_.bvh_node, first.begin, second.begin, self,
            [&](Index a, Index b) { return !(distance_squared(box_[a], box_[b]) > 0); },
            [&](Index a, Index b) {
                return any_in_leaves(inputs_.bvh_node[a], inputs_.bvh_node[b], self && a == b, visit);
            });
    }

private:
    bool any_in_leaves(const BvhNode& own, const BvhNode& other, bool same, auto&& visit) const {
        // Boxes overlap if their squared distance is 0. lanes_below tests for values below a limit, so the limit is the
        // smallest normal number.
        constexpr Real overlap = std::numeric_limits<Real>::min();
        const LeafBoxes first = boxes_of(own), second = boxes_of(other);
        bool found = false;
        for (std::size_t i = 0; i < static_cast<std::size_t>(own.count) && !found; ++i) {
            unsigned lanes = lanes_below(distance_squared(second, lane_of(first, i)), overlap);
            if (same) lanes &= ~0U << (i + 1);  // each pair is tested once
            for_each_lane(lanes, [&](std::size_t j) {
                const Index a = inputs_.leaf_triangle[own.leaf][i], b = inputs_.leaf_triangle[other.leaf][j];
                found = found || any_side(a, b, visit) || any_side(b, a, visit);
            });
        }
        return found;
    }

    LeafBoxes boxes_of(const BvhNode& node) const {
        return boxes_of_triangles(inputs_.leaf_nodes[node.leaf], node.count, inputs_.position);
    }

    bool any_side(Index owner, Index through, auto&& visit) const {
        const auto &edge = inputs_.surface.triangles.node[owner], &face = inputs_.surface.triangles.node[through];
        const auto& x = inputs_.position;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index p = edge[k], q = edge[(k + 1) % 3];
            if (!passes_through(x[p], x[q], x[face[0]], x[face[1]], x[face[2]])) continue;
            if (kind_ == PairKind::self && !counts_in_self(p, q, face)) continue;
            if (visit(owner, k)) return true;
        }
        return false;
    }

    bool was_far_at_rest(Index point, const std::array<Index, 3>& face) const {
        return !inputs_.rest_position.empty() &&
               rest_distance_squared(inputs_, point, face) > least_rest_distance_ * least_rest_distance_;
    }

    /// True if an edge pq that passes through a face of its own body counts as a crossing. Both ends must have been far
    /// from the face at rest. Neither may lie in the plane of the face up to rounding errors, because edges in a flat
    /// side of the body do so without a crossing.
    bool counts_in_self(Index p, Index q, const std::array<Index, 3>& face) const {
        // least height of an end above the plane, as a fraction of least_rest_distance_
        constexpr Real rounding = 1e-9;
        const auto& x = inputs_.position;
        const Vec3 &a = x[face[0]], normal = (x[face[1]] - a).cross(x[face[2]] - a);
        const Real least = rounding * least_rest_distance_ * normal.norm();
        return std::abs(normal.dot(x[p] - a)) > least && std::abs(normal.dot(x[q] - a)) > least &&
               was_far_at_rest(p, face) && was_far_at_rest(q, face);
    }

    const CollisionInputs& inputs_;
    const PairKind kind_;
    const Index first_, second_;
    const Real least_rest_distance_;
    std::span<const Aabb> box_;
};

}  // namespace

bool surfaces_cross(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box) {
    const Real least_rest_distance = 2 * pair.scale.face_depth;  // the limit of was_far_at_rest()
    return CrossingSearch(inputs, pair.kind, pair.first, pair.second, least_rest_distance, box)
        .any([](Index, std::size_t) { return true; });
}

Index count_self_crossings(const CollisionInputs& inputs, Index body, std::span<const Aabb> box) {
    Index count = 0;
    const Real least_rest_distance = own_piece_edges * inputs.body.mean_edge[body];
    CrossingSearch(inputs, PairKind::self, body, body, least_rest_distance, box)
        .any([&](Index owner, std::size_t side) {
            count += inputs.surface.triangles.owned_edges[owner] >> side & 1;
            return false;
        });
    return count;
}

}  // namespace skerry
