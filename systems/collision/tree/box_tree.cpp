#include "systems/collision/tree/box_tree.h"

#include <algorithm>
#include <numeric>

#include "systems/collision/tree/box.h"

namespace skerry {

BoxTree::BoxTree(std::span<const Aabb> boxes) {
    std::vector<Index> items(boxes.size());
    std::iota(items.begin(), items.end(), 0);
    // Boxes that are not finite are left out, because they have no centre by which they could be sorted. Searches never
    // find them.
    std::erase_if(items, [&](Index i) {
        const Aabb& box = boxes[static_cast<std::size_t>(i)];
        return !box.lower.allFinite() || !box.upper.allFinite();
    });
    nodes_.reserve(2 * items.size());
    if (!items.empty()) append(boxes, items);
}

/// Splits the items in half at the median of the centres of their boxes. The split is along the axis on which the
/// centres are spread widest.
void BoxTree::append(std::span<const Aabb> boxes, std::span<Index> items) {
    const auto box_of = [&](Index i) -> const Aabb& { return boxes[static_cast<std::size_t>(i)]; };
    const auto middle_of = [&](Index i) -> Vec3 { return box_of(i).lower + box_of(i).upper; };  // centre times two
    const std::size_t row = nodes_.size();
    nodes_.push_back({empty_box(), row + 1, no_index});
    Aabb all = empty_box(), middles = empty_box();
    for (const Index i : items) {
        grow(all, box_of(i));
        grow(middles, middle_of(i));
    }
    nodes_[row].box = all;
    if (items.size() == 1) {
        nodes_[row].item = items.front();
        return;
    }
    Index axis = 0;
    (middles.upper - middles.lower).maxCoeff(&axis);
    const std::size_t half = items.size() / 2;
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                     [&](Index a, Index b) {
                         const Real at = middle_of(a)[axis], bt = middle_of(b)[axis];
                         return at != bt ? at < bt : a < b;
                     });
    append(boxes, items.first(half));
    append(boxes, items.subspan(half));
    nodes_[row].skip = nodes_.size();
}

}  // namespace skerry
