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

/// Squared distances of eight boxes from the box `to`, by lane; 0 for boxes that overlap `to` [m^2]. `lower`, `upper`:
/// lower and upper coordinates of the eight boxes.
[[gnu::always_inline]] inline Parts<KernelReal> distance_squared(const std::array<Lanes<Real, leaf_lanes>, 3>& lower,
                                                                 const std::array<Lanes<Real, leaf_lanes>, 3>& upper,
                                                                 const Aabb& to) {
    const KernelReal none{};
    Parts<KernelReal> sum{};
    for (std::size_t part = 0; part < kernel_parts; ++part)
        for (std::size_t i = 0; i < 3; ++i) {
            const KernelReal above = load_part<KernelReal>(lower[i], part) - to.upper[static_cast<Index>(i)],
                             below = to.lower[static_cast<Index>(i)] - load_part<KernelReal>(upper[i], part);
            const KernelReal nearer = above > below ? above : below, gap = nearer > none ? nearer : none;
            sum[part] += gap * gap;
        }
    return sum;
}
/// Squared distances of eight boxes from one box, by lane; 0 for boxes that overlap the box [m^2].
[[gnu::always_inline]] inline Parts<KernelReal> distance_squared(const LeafBoxes& boxes, const Aabb& to) {
    return distance_squared(boxes.lower, boxes.upper, to);
}

/// Bit mask of the lanes whose value is below `limit`.
[[gnu::always_inline]] inline unsigned lanes_below(const Parts<KernelReal>& value, Real limit) {
    return bits_of_parts([&](std::size_t part) { return value[part] < limit; });
}

}  // namespace skerry
