// The features of a leaf side by side, for comparing one with eight of them.
#pragma once

#include <array>

#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/tree/leaf_boxes.h"
#include "systems/geometry/lane_vec3.h"

namespace skerry {

/// Three coordinates (m) of eight points.
using PointLanes = std::array<Lanes<Real, leaf_lanes>, 3>;

inline LaneVec3<Real8> load(const PointLanes& points) {
    return {load(points[0]), load(points[1]), load(points[2])};
}
inline LaneVec3<Real8> spread(const Vec3& point) {
    return {Real8{} + point[0], Real8{} + point[1], Real8{} + point[2]};
}
inline void set_lane(PointLanes& points, std::size_t lane, const Vec3& point) {
    for (std::size_t i = 0; i < 3; ++i) points[i][lane] = point[static_cast<Index>(i)];
}

/// The corners of the triangles of a leaf. Lanes without a triangle repeat the first.
struct LeafCorners {
    Index leaf = no_index;  // row of BvhLeafTable
    std::array<PointLanes, 3> corner;

    void fill(const CollisionInputs& inputs, Index of_leaf) {
        leaf = of_leaf;
        const LeafTriangles& triangle = inputs.leaf_triangle[static_cast<std::size_t>(leaf)];
        for (std::size_t l = 0; l < leaf_lanes; ++l) {
            const Index row = triangle[l] == no_index ? triangle[0] : triangle[l];
            for (std::size_t k = 0; k < 3; ++k)
                set_lane(corner[k], l, inputs.position[inputs.surface.triangles.node[row][k]]);
        }
    }
};

/// The edges that the triangles of a leaf own.
struct LeafEdges {
    static constexpr std::size_t most = 3 * leaf_lanes;
    Index leaf = no_index;         // row of BvhLeafTable
    std::array<LeafBoxes, 3> box;  // eight at a time; lanes behind the last edge are empty
    std::array<std::array<PointLanes, 2>, 3> end;
    std::array<Index, most> edge;  // row of EdgeTable
    std::array<std::array<Index, 2>, most> node;
    std::size_t count = 0;

    void fill(const CollisionInputs& inputs, Index of_leaf) {
        leaf = of_leaf;
        count = 0;
        const TriangleTable& table = inputs.surface.triangles;
        for (const Index row : inputs.leaf_triangle[static_cast<std::size_t>(leaf)]) {
            if (row == no_index) break;
            for (std::size_t k = 0; k < 3; ++k)
                if (table.owned_edges[row] >> k & 1)
                    append(inputs, table.edge[row][k], {table.node[row][k], table.node[row][(k + 1) % 3]});
        }
        for (std::size_t i = count; i % leaf_lanes != 0; ++i) {
            set_lane(box[i / leaf_lanes], i % leaf_lanes, empty_box());
            for (PointLanes& points : end[i / leaf_lanes]) set_lane(points, i % leaf_lanes, Vec3::Zero());
        }
    }
    std::size_t groups() const { return (count + leaf_lanes - 1) / leaf_lanes; }

private:
    void append(const CollisionInputs& inputs, Index row, const std::array<Index, 2>& ends) {
        const Vec3 &a = inputs.position[ends[0]], &b = inputs.position[ends[1]];
        const std::size_t group = count / leaf_lanes, lane = count % leaf_lanes;
        set_lane(box[group], lane, {a.cwiseMin(b), a.cwiseMax(b)});
        set_lane(end[group][0], lane, a);
        set_lane(end[group][1], lane, b);
        edge[count] = row;
        node[count++] = ends;
    }
};

}  // namespace skerry
