// Features of a leaf of a bounding volume hierarchy, stored in vectors of eight, so that one feature is compared with
// eight features at once.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/tree/leaf_boxes.h"
#include "systems/geometry/lane_mask.h"

namespace skerry {

/// Coordinates of eight points: vectors of the x, y and z coordinates [m].
using PointLanes = std::array<Lanes<Real, leaf_lanes>, 3>;

/// Writes to lane l of `box` the bounding box of the points in lane l of points[0] to points[Count - 1].
template <std::size_t Count>
void find_bounds(const std::array<PointLanes, Count>& points, LeafBoxes& box) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            KernelReal lower = load_part<KernelReal>(points[0][i], part), upper = lower;
            for (std::size_t k = 1; k < Count; ++k) {
                const KernelReal at = load_part<KernelReal>(points[k][i], part);
                lower = lower < at ? lower : at;
                upper = upper < at ? at : upper;
            }
            store_part(lower, box.lower[i], part);
            store_part(upper, box.upper[i], part);
        }
}

/// Returns the positions of eight nodes.
inline PointLanes lanes_of_points(std::span<const Vec3> position, const std::array<Index, leaf_lanes>& node) {
    PointLanes lanes;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto at = [&](std::size_t l) {
            return position[static_cast<std::size_t>(node[l])][static_cast<Index>(i)];
        };
        store(Real8{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)}, lanes[i]);
    }
    return lanes;
}

/// Boxes of the triangles in a leaf. Unused lanes repeat the first triangle.
struct LeafTriangleBoxes {
    Index leaf = no_index;  // row of BvhLeafTable
    LeafBoxes box;

    void fill(const CollisionInputs& inputs, Index of_leaf) {
        leaf = of_leaf;
        const LeafNodes& nodes = inputs.leaf_nodes[static_cast<std::size_t>(leaf)];
        std::array<PointLanes, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = lanes_of_points(inputs.position, nodes.corner[k]);
        find_bounds(corner, box);
    }
};

/// Squared distances of eight points from a box; 0 for points inside the box [m^2].
[[gnu::always_inline]] inline Parts<KernelReal> distance_squared(const PointLanes& point, const Aabb& to) {
    return distance_squared(point, point, to);
}

/// Number of groups of eight features that `count` features need. The last group may have unused lanes.
inline std::size_t groups_of(Index count) {
    return (static_cast<std::size_t>(count) + leaf_lanes - 1) / leaf_lanes;
}
inline unsigned used_lanes(Index count, std::size_t group) {
    const std::size_t left = static_cast<std::size_t>(count) - leaf_lanes * group;
    return left < leaf_lanes ? (1U << left) - 1 : (1U << leaf_lanes) - 1;
}

/// The vertices that the triangles of a leaf own. Each vertex is owned by exactly one triangle of the surface, so that
/// a search compares it once.
struct LeafPoints {
    Index leaf = no_index;  // row of BvhLeafTable
    const LeafFeatures* list = nullptr;
    std::array<PointLanes, 3> at;  // groups of eight points; lanes after the last point repeat the last point

    void fill(const CollisionInputs& inputs, Index of_leaf) {
        leaf = of_leaf;
        list = &inputs.leaf_features[static_cast<std::size_t>(leaf)];
        for (std::size_t group = 0; group < groups(); ++group) {
            std::array<Index, leaf_lanes> node;
            for (std::size_t l = 0; l < leaf_lanes; ++l)
                node[l] =
                    list->point[std::min(leaf_lanes * group + l, static_cast<std::size_t>(list->point_count) - 1)].node;
            at[group] = lanes_of_points(inputs.position, node);
        }
    }
    std::size_t groups() const { return groups_of(list->point_count); }
    unsigned used(std::size_t group) const { return used_lanes(list->point_count, group); }
};

/// The edges that the triangles of a leaf own. Each edge is owned by exactly one triangle of the surface, so that a
/// search compares it once.
struct LeafEdges {
    Index leaf = no_index;  // row of BvhLeafTable
    const LeafFeatures* list = nullptr;
    std::array<LeafBoxes, 3> box;  // groups of eight edges; lanes after the last edge repeat the last edge

    void fill(const CollisionInputs& inputs, Index of_leaf) {
        leaf = of_leaf;
        list = &inputs.leaf_features[static_cast<std::size_t>(leaf)];
        for (std::size_t group = 0; group < groups(); ++group) {
            std::array<std::array<Index, leaf_lanes>, 2> node;
            for (std::size_t l = 0; l < leaf_lanes; ++l) {
                const auto& edge =
                    list->edge[std::min(leaf_lanes * group + l, static_cast<std::size_t>(list->edge_count) - 1)];
                for (std::size_t k = 0; k < 2; ++k) node[k][l] = edge.node[k];
            }
            std::array<PointLanes, 2> end;
            for (std::size_t k = 0; k < 2; ++k) end[k] = lanes_of_points(inputs.position, node[k]);
            find_bounds(end, box[group]);
        }
    }
    std::size_t count() const { return static_cast<std::size_t>(list->edge_count); }
    std::size_t groups() const { return groups_of(list->edge_count); }
    unsigned used(std::size_t group) const { return used_lanes(list->edge_count, group); }
    Index row(std::size_t i) const { return list->edge[i].row; }
    const std::array<Index, 2>& node(std::size_t i) const { return list->edge[i].node; }
};

}  // namespace skerry
