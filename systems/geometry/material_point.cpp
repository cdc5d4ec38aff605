#include "systems/geometry/material_point.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace skerry {

MaterialPoint point_of_tetrahedron(std::span<const Vec3> nodes, const std::array<Index, 4>& corners,
                                   const Vec3& position) {
    const auto at = [&](std::size_t k) -> const Vec3& { return nodes[static_cast<std::size_t>(corners[k])]; };
    Mat3 edges;
    for (std::size_t k = 0; k < 3; ++k) edges.col(static_cast<Eigen::Index>(k)) = at(k + 1) - at(0);
    const Vec3 weight = edges.inverse() * (position - at(0));
    return {corners, {1 - weight.sum(), weight.x(), weight.y(), weight.z()}};
}

MaterialPoint point_of_solid(std::span<const Vec3> nodes, const Vec3& position) {
    const auto farthest = [&](auto&& distance) -> Index {
        std::size_t found = 0;
        for (std::size_t n = 1; n < nodes.size(); ++n)
            if (distance(nodes[n]) > distance(nodes[found])) found = n;
        return static_cast<Index>(found);
    };
    const auto at = [&](Index n) -> const Vec3& { return nodes[static_cast<std::size_t>(n)]; };
    const Index a = farthest([&](const Vec3& x) { return (x - nodes[0]).squaredNorm(); });
    const Index b = farthest([&](const Vec3& x) { return (x - at(a)).squaredNorm(); });
    const Vec3 edge = at(b) - at(a);
    const Index c = farthest([&](const Vec3& x) { return edge.cross(x - at(a)).squaredNorm(); });
    const Vec3 normal = edge.cross(at(c) - at(a));
    const Index d = farthest([&](const Vec3& x) { return std::abs(normal.dot(x - at(a))); });
    return point_of_tetrahedron(nodes, {a, b, c, d}, position);
}

std::optional<MaterialPoint> point_inside(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& position) {
    // Tolerance for rounding errors of barycentric coordinates. With it, a point on the common face of two tetrahedra
    // always belongs to the tetrahedron that comes first.
    constexpr Real rounding = 1e-9;
    for (const std::array<Index, 4>& corners : tetrahedra) {
        const MaterialPoint point = point_of_tetrahedron(nodes, corners, position);
        if (std::ranges::all_of(point.weight, [](Real weight) { return weight >= -rounding; })) return point;
    }
    return {};
}

}  // namespace skerry
