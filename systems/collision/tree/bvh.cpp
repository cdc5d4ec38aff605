#include "systems/collision/tree/bvh.h"

#include <algorithm>
#include <vector>

#include "components/check.h"
#include "systems/collision/tree/box.h"
#include "systems/collision/tree/leaf_boxes.h"

namespace skerry {

namespace {

struct Build {
    std::span<const std::array<Index, 3>> triangle_node;
    std::span<const Vec3> position;
    std::vector<Index> order;  // triangles
    BvhTable& bvh;
    BvhLeafTable& leaves;

    Vec3 centre(Index triangle) const {  // times three
        const auto& node = triangle_node[triangle];
        return position[node[0]] + position[node[1]] + position[node[2]];
    }

    /// Splits the triangles first .. end - 1 of `order` about the median of the longest axis, where it leaves full
    /// leaves: depth is log2, whatever the shape.
    void append(Index first, Index end) {
        const Index row = static_cast<Index>(bvh.node.size());
        bvh.node.push_back({row + 1, no_index, no_index, 0});
        bvh.box.push_back(empty_box());
        if (end - first <= leaf_lanes) {
            append_leaf(first, end, bvh.node[row]);
            return;
        }
        Aabb box = empty_box();
        for (Index i = first; i < end; ++i) grow(box, centre(order[i]));
        const Vec3 size = box.upper - box.lower;
        const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
        const Index half = (end - first) / 2, middle = first + std::max(leaf_lanes, half - half % leaf_lanes);
        // Ties by row: the tree depends on the mesh alone. Positions are finite here, the scene builder has checked.
        std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + end, [&](Index a, Index b) {
            const Real ca = centre(a)[axis], cb = centre(b)[axis];
            return ca != cb ? ca < cb : a < b;
        });
        append(first, middle);
        bvh.node[row].right = static_cast<Index>(bvh.node.size());
        append(middle, end);
        bvh.node[row].skip = static_cast<Index>(bvh.node.size());
    }

    void append_leaf(Index first, Index end, BvhNode& node) {
        node.leaf = static_cast<Index>(leaves.triangle.size());
        node.count = end - first;
        LeafTriangles triangles;
        triangles.fill(no_index);
        std::copy(order.begin() + first, order.begin() + end, triangles.begin());
        leaves.triangle.push_back(triangles);
        leaves.box.push_back(empty_leaf());
    }
};

/// The lesser of both in each lane, a where b is not a number; the same for the greater.
template <class T>
[[gnu::always_inline]] inline T lesser(const T& a, const T& b) {
    return b < a ? b : a;
}
template <class T>
[[gnu::always_inline]] inline T greater(const T& a, const T& b) {
    return b > a ? b : a;
}

/// The least of the lanes by `pick` of two. Written out: no loop is unrolled at -O2.
[[gnu::always_inline]] inline Real pick_of(const Lanes<Real, leaf_lanes>& lanes, auto&& pick) {
    const Real4 four = pick(half_at(lanes.lane), half_at(lanes.lane + leaf_lanes / 2));
    return pick(pick(Real(four[0]), Real(four[1])), pick(Real(four[2]), Real(four[3])));
}

/// Fits the boxes of the first `count` lanes, side by side; the others stay empty. Returns the box around them.
Aabb fit_leaf(const LeafTriangles& triangle, Index count, std::span<const std::array<Index, 3>> triangle_node,
              std::span<const Vec3> position, LeafBoxes& boxes) {
    std::array<std::array<const Real*, leaf_lanes>, 3> corner;
    for (std::size_t l = 0; l < leaf_lanes; ++l) {
        const std::array<Index, 3>& node = triangle_node[triangle[l] == no_index ? triangle[0] : triangle[l]];
        corner[0][l] = position[node[0]].data();
        corner[1][l] = position[node[1]].data();
        corner[2][l] = position[node[2]].data();
    }
    const auto coordinate = [&](std::size_t k, int i) {
        const auto& p = corner[k];
        return Real8{p[0][i], p[1][i], p[2][i], p[3][i], p[4][i], p[5][i], p[6][i], p[7][i]};
    };
    Aabb all;
    for (int i = 0; i < 3; ++i) {
        const Real8 none = Real8{} + infinite, a = coordinate(0, i), b = coordinate(1, i), c = coordinate(2, i);
        Lanes<Real, leaf_lanes>&lower = boxes.lower[static_cast<std::size_t>(i)],
                    &upper = boxes.upper[static_cast<std::size_t>(i)];
        store(lesser(lesser(lesser(none, a), b), c), lower);
        store(greater(greater(greater(-none, a), b), c), upper);
        // lanes without a triangle repeat the first here
        all.lower[i] = pick_of(lower, [](const auto& x, const auto& y) { return lesser(x, y); });
        all.upper[i] = pick_of(upper, [](const auto& x, const auto& y) { return greater(x, y); });
    }
    for (std::size_t l = static_cast<std::size_t>(count); l < leaf_lanes; ++l) set_lane(boxes, l, empty_box());
    return all;
}

}  // namespace

BvhRanges append_bvh(Range triangles, std::span<const std::array<Index, 3>> triangle_node,
                     std::span<const Vec3> position, BvhTable& bvh, BvhLeafTable& leaves) {
    const auto first_node = static_cast<Index>(bvh.node.size()),
               first_leaf = static_cast<Index>(leaves.triangle.size());
    if (triangles.size() == 0) return {{first_node, first_node}, {first_leaf, first_leaf}};
    Build build{triangle_node, position, {}, bvh, leaves};
    for (Index t = triangles.begin; t < triangles.end; ++t) build.order.push_back(t);
    build.append(0, triangles.size());
    const BvhRanges ranges{{first_node, static_cast<Index>(bvh.node.size())},
                           {first_leaf, static_cast<Index>(leaves.triangle.size())}};
    refit_bvh(ranges.nodes, bvh.node, leaves.triangle, triangle_node, position, bvh.box, leaves.box);
    return ranges;
}

void append_leaf_features(Range bvh_leaves, const TriangleTable& triangles, BvhLeafTable& leaves) {
    SKERRY_CHECK(leaves.features.size() == static_cast<std::size_t>(bvh_leaves.begin));
    for (Index leaf = bvh_leaves.begin; leaf < bvh_leaves.end; ++leaf) {
        LeafFeatures features;
        for (const Index row : leaves.triangle[leaf]) {
            if (row == no_index) break;
            const auto& node = triangles.node[row];
            for (std::size_t k = 0; k < 3; ++k) {
                if (triangles.owned_edges[row] >> k & 1)
                    features.edge[static_cast<std::size_t>(features.edge_count++)] = {triangles.edge[row][k],
                                                                                      {node[k], node[(k + 1) % 3]}};
                if (triangles.owned_vertices[row] >> k & 1)
                    features.point[static_cast<std::size_t>(features.point_count++)] = {triangles.vertex[row][k],
                                                                                        node[k]};
            }
        }
        leaves.features.push_back(features);
    }
}

void refit_bvh(Range bvh_nodes, std::span<const BvhNode> node, std::span<const LeafTriangles> leaf_triangle,
               std::span<const std::array<Index, 3>> triangle_node, std::span<const Vec3> position, std::span<Aabb> box,
               std::span<LeafBoxes> leaf_box) {
    // Children follow their parent, so backwards is bottom-up.
    for (Index row = bvh_nodes.end - 1; row >= bvh_nodes.begin; --row) {
        const BvhNode& own = node[row];
        if (own.count > 0) {
            box[row] = fit_leaf(leaf_triangle[own.leaf], own.count, triangle_node, position, leaf_box[own.leaf]);
        } else {
            box[row] = box[row + 1];
            grow(box[row], box[own.right]);
        }
    }
}

}  // namespace skerry
