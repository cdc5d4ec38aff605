// Eight boxes that are compared with one box at once. NaN coordinates are ignored, as in box.h.
#pragma once

#include <array>
#include <span>

#include "components/lanes.h"
#include "systems/collision/tree/box.h"
#include "systems/geometry/lane_mask.h"

namespace skerry {

static_assert(leaf_lanes == element_lanes, "a leaf must fill all lanes of Real8");

/// Eight boxes, stored by coordinate, so that one box is compared with all of them at once [m]. An empty box has an
/// infinite distance from all other boxes.
struct LeafBoxes {
    std::array<Lanes<Real, leaf_lanes>, 3> lower, upper;  // coordinates by axis
};

inline void set_lane(LeafBoxes& boxes, std::size_t lane, const Aabb& box) {
    for (std::size_t i = 0; i < 3; ++i) {
        boxes.lower[i][lane] = box.lower[static_cast<Index>(i)];
        boxes.upper[i][lane] = box.upper[static_cast<Index>(i)];
    }
}

inline Aabb lane_of(const LeafBoxes& boxes, std::size_t lane) {
    return {{boxes.lower[0][lane], boxes.lower[1][lane], boxes.lower[2][lane]},
            {boxes.upper[0][lane], boxes.upper[1][lane], boxes.upper[2][lane]}};
}

inline LeafBoxes empty_leaf() {
    LeafBoxes boxes;
    for (std::size_t l = 0; l < leaf_lanes; ++l) set_lane(boxes, l, empty_box());
    return boxes;
}

/// Boxes of the first `count` triangles of a leaf. The boxes in the other lanes are empty.
inline LeafBoxes boxes_of_triangles(const LeafNodes& nodes, Index count, std::span<const Vec3> position) {
    LeafBoxes boxes = empty_leaf();
    for (std::size_t l = 0; l < static_cast<std::size_t>(count); ++l) {
        Aabb box = empty_box();
        for (const auto& corner : nodes.corner) grow(box, position[static_cast<std::size_t>(corner[l])]);
        set_lane(boxes, l, box);
    }
    return boxes;
}

/// Squared distances of eight boxes from one box, by lane; 0 for boxes that overlap the box [m^2].
inline Real8 distance_squared(const LeafBoxes& boxes, const Aabb& to) {
    const Real8 none{};
    Real8 sum{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Real8 above = load(boxes.lower[i]) - to.upper[static_cast<Index>(i)],
                    below = to.lower[static_cast<Index>(i)] - load(boxes.upper[i]);
        const Real8 nearer = above > below ? above : below, gap = nearer > none ? nearer : none;
        sum += gap * gap;
    }
    return sum;
}

/// Bit mask of the lanes whose value is below `limit`.
inline unsigned lanes_below(const Real8& value, Real limit) {
    return bits_of(value < Real8{} + limit);
}

}  // namespace skerry
