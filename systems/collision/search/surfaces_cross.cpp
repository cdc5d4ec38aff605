#include "systems/collision/search/search_pair.h"

#include <limits>

#include "systems/collision/narrow/rest_distance.h"
#include "systems/collision/tree/leaf_boxes.h"
#include "systems/collision/tree/leaf_pairs.h"
#include "systems/geometry/passes_through.h"

namespace skerry {

namespace {

class CrossingSearch {
public:
    CrossingSearch(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box)
        : inputs_(inputs), pair_(pair), box_(box) {}

    bool run() const {
        const bool self = pair_.kind == PairKind::self;
        return any_leaf_pair(
            inputs_.bvh_node, inputs_.body.bvh_nodes[pair_.first].begin, inputs_.body.bvh_nodes[pair_.second].begin,
            self, [&](Index a, Index b) { return !(distance_squared(box_[a], box_[b]) > 0); },
            [&](Index a, Index b) { return leaves_cross(inputs_.bvh_node[a], inputs_.bvh_node[b], self && a == b); });
    }

private:
    bool leaves_cross(const BvhNode& own, const BvhNode& other, bool same) const {
        // Upper limit of the squared distance of overlapping boxes. Denormal numbers may count as 0.
        constexpr Real overlap = std::numeric_limits<Real>::min();
        const LeafBoxes first = boxes_of(own), second = boxes_of(other);
        bool crossing = false;
        for (std::size_t i = 0; i < static_cast<std::size_t>(own.count) && !crossing; ++i) {
            unsigned lanes = lanes_below(distance_squared(second, lane_of(first, i)), overlap);
            if (same) lanes &= ~0U << (i + 1);  // each pair is tested once
            for_each_lane(lanes, [&](std::size_t j) {
                crossing = crossing ||
                           triangles_cross(inputs_.leaf_triangle[own.leaf][i], inputs_.leaf_triangle[other.leaf][j]);
            });
        }
        return crossing;
    }

    LeafBoxes boxes_of(const BvhNode& node) const {
        return boxes_of_triangles(inputs_.leaf_nodes[node.leaf], node.count, inputs_.position);
    }

    bool triangles_cross(Index a, Index b) const { return edges_pass(a, b) || edges_pass(b, a); }

    bool edges_pass(Index owner, Index through) const {
        const auto &edge = inputs_.surface.triangles.node[owner], &face = inputs_.surface.triangles.node[through];
        const auto& x = inputs_.position;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index p = edge[k], q = edge[(k + 1) % 3];
            if (!passes_through(x[p], x[q], x[face[0]], x[face[1]], x[face[2]])) continue;
            if (pair_.kind != PairKind::self) return true;
            if (was_far_at_rest(inputs_, pair_.scale, p, face) && was_far_at_rest(inputs_, pair_.scale, q, face))
                return true;
        }
        return false;
    }

    const CollisionInputs& inputs_;
    const PairToSearch& pair_;
    std::span<const Aabb> box_;
};

}  // namespace

bool surfaces_cross(const CollisionInputs& inputs, const PairToSearch& pair, std::span<const Aabb> box) {
    const Range first = inputs.body.bvh_nodes[pair.first], second = inputs.body.bvh_nodes[pair.second];
    if (first.size() == 0 || second.size() == 0) return false;
    return CrossingSearch(inputs, pair, box).run();
}

}  // namespace skerry
