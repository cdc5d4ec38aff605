#include "systems/collision/tree/bvh.h"

#include <algorithm>
#include <vector>

#include "components/check.h"
#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

struct Build {
    std::span<const std::array<Index, 3>> triangle_node;
    std::span<const Vec3> position;
    std::vector<Index> order;  // triangles in the order of the leaves
    BvhTable& bvh;
    BvhLeafTable& leaves;

    Vec3 centre(Index triangle) const {  // centre of a triangle, times three
        const auto& node = triangle_node[triangle];
        return position[node[0]] + position[node[1]] + position[node[2]];
    }

    /// Splits the triangles order[first .. end - 1] near the median of their centres, along the axis on which the
    /// centres are spread widest. The size of the left half is a multiple of the leaf size, so that at most one leaf is
    /// not full. The depth of the tree is logarithmic for all shapes.
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
        // Triangles with equal coordinates are sorted by row, so that the tree depends only on the mesh. All positions
        // are finite here, because the scene builder has checked them.
        std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + end, [&](Index a, Index b) {
            const Real ca = centre(a)[axis], cb = centre(b)[axis];
            return ca != cb ? ca < cb : a < b;
        });
        append(first, middle);
        bvh.node[row].right = static_cast<Index>(bvh.node.size());
        append(middle, end);
        bvh.node[row].skip = static_cast<Index>(bvh.node.size());
    }

    LeafNodes nodes_of(const LeafTriangles& triangles) const {
        LeafNodes nodes;
        std::size_t corners = 0;
        for (std::size_t l = 0; l < leaf_lanes; ++l) {
            const auto& node = triangle_node[triangles[l] == no_index ? triangles[0] : triangles[l]];
            for (std::size_t k = 0; k < 3; ++k) nodes.corner[k][l] = nodes.node[corners++] = node[k];
        }
        std::ranges::sort(nodes.node);
        nodes.count = static_cast<Index>(std::unique(nodes.node.begin(), nodes.node.end()) - nodes.node.begin());
        return nodes;
    }

    void append_leaf(Index first, Index end, BvhNode& node) {
        node.leaf = static_cast<Index>(leaves.triangle.size());
        node.count = end - first;
        LeafTriangles triangles;
        triangles.fill(no_index);
        std::copy(order.begin() + first, order.begin() + end, triangles.begin());
        leaves.triangle.push_back(triangles);
        leaves.nodes.push_back(nodes_of(triangles));
    }
};

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
    refit_bvh(ranges.nodes, bvh.node, leaves.nodes, position, bvh.box);
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

BvhRanges append_bvh_copy(const BvhRanges& original, const RowOffsets& offset, std::span<const Vec3> position,
                          BvhTable& bvh, BvhLeafTable& leaves) {
    const auto first_node = static_cast<Index>(bvh.node.size()),
               first_leaf = static_cast<Index>(leaves.triangle.size());
    const BvhRanges ranges{{first_node, first_node + original.nodes.size()},
                           {first_leaf, first_leaf + original.leaves.size()}};
    const Index nodes_on = ranges.nodes.begin - original.nodes.begin,
                leaves_on = ranges.leaves.begin - original.leaves.begin;
    append_copies(bvh.node, original.nodes, [&](BvhNode& node) {
        add_offset(node.skip, nodes_on);
        add_offset(node.right, nodes_on);
        add_offset(node.leaf, leaves_on);
    });
    append_copies(leaves.triangle, original.leaves, [&](LeafTriangles& rows) { add_offset(rows, offset.triangles); });
    append_copies(leaves.nodes, original.leaves, [&](LeafNodes& nodes) {
        for (auto& corner : nodes.corner) add_offset(corner, offset.nodes);
        for (std::size_t i = 0; i < LeafNodes::capacity; ++i) add_offset(nodes.node[i], offset.nodes);
    });
    append_copies(leaves.features, original.leaves, [&](LeafFeatures& features) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(features.edge_count); ++i) {
            add_offset(features.edge[i].row, offset.edges);
            add_offset(features.edge[i].node, offset.nodes);
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(features.point_count); ++i) {
            add_offset(features.point[i].row, offset.vertices);
            add_offset(features.point[i].node, offset.nodes);
        }
    });
    bvh.box.resize(bvh.node.size());
    refit_bvh(ranges.nodes, bvh.node, leaves.nodes, position, bvh.box);
    return ranges;
}

void refit_bvh(Range bvh_nodes, std::span<const BvhNode> node, std::span<const LeafNodes> leaf_nodes,
               std::span<const Vec3> position, std::span<Aabb> box) {
    // Children follow their parent, so a backward loop visits the children first.
    for (Index row = bvh_nodes.end - 1; row >= bvh_nodes.begin; --row) {
        const BvhNode& own = node[row];
        Aabb around = own.count > 0 ? empty_box() : box[row + 1];
        if (own.count > 0) {
            const LeafNodes& leaf = leaf_nodes[own.leaf];
            for (std::size_t i = 0; i < static_cast<std::size_t>(leaf.count); ++i)
                grow(around, position[static_cast<std::size_t>(leaf.node[i])]);
        } else {
            grow(around, box[own.right]);
        }
        box[row] = around;
    }
}

}  // namespace skerry
