#include "engine/mesh/repair/triangle_tree.h"

#include <Eigen/Geometry>
#include <utility>

#include "systems/collision/tree/box.h"
#include "systems/collision/tree/bvh.h"
#include "systems/geometry/closest_points.h"

namespace skerry::mesh {

TriangleTree::TriangleTree(SurfaceMesh surface) : surface_(std::move(surface)) {
    append_bvh({0, static_cast<Index>(surface_.triangles.size())}, surface_.triangles, surface_.nodes, bvh_, leaves_);
}

NearestTriangle TriangleTree::nearest(const Vec3& point, Real limit) const {
    NearestTriangle nearest{.distance_squared = limit};
    search(0, point, nullptr, nearest);
    return nearest;
}

NearestTriangle TriangleTree::nearest_facing(const Vec3& point, const Vec3& facing, Real limit) const {
    NearestTriangle nearest{.distance_squared = limit};
    search(0, point, &facing, nearest);
    return nearest;
}

bool TriangleTree::faces(Index triangle, const Vec3& point, const Vec3& facing) const {
    const auto& corners = surface_.triangles[static_cast<std::size_t>(triangle)];
    const auto at = [&](std::size_t k) -> const Vec3& { return surface_.nodes[static_cast<std::size_t>(corners[k])]; };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    return normal.dot(facing) > 0 && normal.dot(point - at(0)) > 0;
}

void TriangleTree::search(Index row, const Vec3& point, const Vec3* facing, NearestTriangle& nearest) const {
    const BvhNode& node = bvh_.node[static_cast<std::size_t>(row)];
    if (node.leaf != no_index) {
        for (const Index t : leaves_.triangle[static_cast<std::size_t>(node.leaf)]) {
            if (t == no_index) break;
            const auto [a, b, c] = surface_.triangles[static_cast<std::size_t>(t)];
            const PointTriangle found = closest_point_on_triangle(point, surface_.nodes[static_cast<std::size_t>(a)],
                                                                  surface_.nodes[static_cast<std::size_t>(b)],
                                                                  surface_.nodes[static_cast<std::size_t>(c)]);
            if (found.distance_squared < nearest.distance_squared && (!facing || faces(t, point, *facing)))
                nearest = {t, found.weight, found.distance_squared};
        }
        return;
    }
    // Visits the nearer child first, because its result often excludes the other child.
    Index child[2] = {row + 1, node.right};
    Real gap[2];
    for (int i = 0; i < 2; ++i) gap[i] = skerry::distance_squared(bvh_.box[static_cast<std::size_t>(child[i])], point);
    const int first = gap[1] < gap[0];
    for (const int i : {first, 1 - first})
        if (gap[i] < nearest.distance_squared) search(child[i], point, facing, nearest);
}

}  // namespace skerry::mesh
