// Tree over the boxes of arbitrary items, for sets that are searched only once. For sets that are searched in every
// step see tree/bvh.h.
#pragma once

#include <span>
#include <vector>

#include "components/bvh_table.h"

namespace skerry {

/// True if the intersection of two boxes has a volume. Boxes that only share a face do not overlap. A box with a NaN
/// coordinate overlaps nothing.
inline bool boxes_overlap(const Aabb& a, const Aabb& b) {
    for (int i = 0; i < 3; ++i)
        if (!(a.lower[i] < b.upper[i] && b.lower[i] < a.upper[i])) return false;
    return true;
}

class BoxTree {
public:
    BoxTree() = default;
    explicit BoxTree(std::span<const Aabb> boxes);

    /// Calls visit(item) for every item with touches(box of the item). If touches(box) is true for a box, it must also
    /// be true for every larger box that contains it: the search skips a subtree if touches() is false for its box. The
    /// order of the calls depends only on the boxes.
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
    /// Calls visit(item) for every item whose box overlaps `box`.
    template <class Visit>
    void for_each_overlap(const Aabb& box, Visit&& visit) const {
        for_each([&box](const Aabb& other) { return boxes_overlap(box, other); }, visit);
    }

private:
    /// Node of the tree. The nodes are stored in depth-first order, as in BvhNode: children follow their parent, and
    /// `skip` is one past the last descendant.
    struct Node {
        Aabb box;
        std::size_t skip;
        Index item;  // the item of a leaf; no_index for an inner node
    };

    void append(std::span<const Aabb> boxes, std::span<Index> items);

    std::vector<Node> nodes_;
};

}  // namespace skerry
