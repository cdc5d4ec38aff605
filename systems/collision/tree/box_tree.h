// A tree over boxes of any items, for sets that are searched once and not in every step (tree/bvh.h is for those).
#pragma once

#include <span>
#include <vector>

#include "components/bvh_table.h"

namespace skerry {

/// True if two boxes share more than a face. A box with a coordinate that is not a number shares nothing.
inline bool boxes_overlap(const Aabb& a, const Aabb& b) {
    for (int i = 0; i < 3; ++i)
        if (!(a.lower[i] < b.upper[i] && b.lower[i] < a.upper[i])) return false;
    return true;
}

class BoxTree {
public:
    BoxTree() = default;
    explicit BoxTree(std::span<const Aabb> boxes);

    /// Calls visit(item) for every box for which touches(box) holds. If touches holds for a box, it must hold for any
    /// box around it. The order depends on the boxes alone.
    template <class Touches, class Visit>
    void for_each(Touches&& touches, Visit&& visit) const {
        for (std::size_t row = 0; row < nodes_.size();) {
            const Node& node = nodes_[row];
            if (!touches(node.box)) {
                row = node.skip;
                continue;
            }
            if (node.item != no_index) visit(node.item);
            ++row;
        }
    }
    /// Calls visit(item) for every box that overlaps `box`.
    template <class Visit>
    void for_each_overlap(const Aabb& box, Visit&& visit) const {
        for_each([&box](const Aabb& other) { return boxes_overlap(box, other); }, visit);
    }

private:
    /// Depth-first, as BvhNode: children follow their parent, `skip` is one past the last descendant.
    struct Node {
        Aabb box;
        std::size_t skip;
        Index item;  // no_index in an inner node
    };

    void append(std::span<const Aabb> boxes, std::span<Index> items);

    std::vector<Node> nodes_;
};

}  // namespace skerry
