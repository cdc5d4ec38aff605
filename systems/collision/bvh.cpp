#include "systems/collision/bvh.h"

#include <algorithm>
#include <limits>

#include "systems/collision/box.h"

namespace skerry {

namespace {

struct Build {
    std::span<const std::array<Index, 3>> triangle_node;
    std::span<const Vec3> position;
    BvhTable& bvh;

    Vec3 centre(Index triangle) const {  // times three
        const auto& node = triangle_node[triangle];
        return position[node[0]] + position[node[1]] + position[node[2]];
    }

    /// Splits the triangles first .. end - 1 of BvhTable::triangle at the median of the longest axis: depth is log2, whatever the shape.
    void append(Index first, Index end) {
        const Index row = static_cast<Index>(bvh.node.size());
        bvh.node.push_back({row + 1, no_index, first, end - first});
        bvh.box.push_back(empty_box());
        if (end - first == 1) return;

        Aabb box = empty_box();
        for (Index i = first; i < end; ++i) grow(box, centre(bvh.triangle[i]));
        const Vec3 size = box.upper - box.lower;
        const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
        const Index middle = first + (end - first) / 2;
        // Ties by row: the tree depends on the mesh alone. Positions are finite here, the scene builder has checked.
        std::nth_element(bvh.triangle.begin() + first, bvh.triangle.begin() + middle, bvh.triangle.begin() + end, [&](Index a, Index b) {
            const Real ca = centre(a)[axis], cb = centre(b)[axis];
            return ca != cb ? ca < cb : a < b;
        });
        append(first, middle);
        bvh.node[row].right = static_cast<Index>(bvh.node.size());
        append(middle, end);
        bvh.node[row].skip = static_cast<Index>(bvh.node.size());
        bvh.node[row].first = no_index;
        bvh.node[row].count = 0;
    }
};

}  // namespace

Range append_bvh(Range triangles, std::span<const std::array<Index, 3>> triangle_node, std::span<const Vec3> position, BvhTable& bvh) {
    Range range{static_cast<Index>(bvh.node.size()), static_cast<Index>(bvh.node.size())};
    if (triangles.size() == 0) return range;
    const Index first = static_cast<Index>(bvh.triangle.size());
    for (Index t = triangles.begin; t < triangles.end; ++t) bvh.triangle.push_back(t);
    Build{triangle_node, position, bvh}.append(first, first + triangles.size());
    range.end = static_cast<Index>(bvh.node.size());
    refit_bvh(range, bvh.node, bvh.triangle, triangle_node, position, bvh.box);
    return range;
}

void refit_bvh(Range bvh_nodes, std::span<const BvhNode> node, std::span<const Index> leaf_triangle,
               std::span<const std::array<Index, 3>> triangle_node, std::span<const Vec3> position, std::span<Aabb> box) {
    // Children follow their parent, so backwards is bottom-up.
    for (Index row = bvh_nodes.end - 1; row >= bvh_nodes.begin; --row) {
        Aabb fitted = empty_box();
        if (node[row].count > 0) {
            for (Index n : triangle_node[leaf_triangle[node[row].first]]) grow(fitted, position[n]);
        } else {
            fitted = box[row + 1];
            grow(fitted, box[node[row].right]);
        }
        box[row] = fitted;
    }
}

}  // namespace skerry
