#include "systems/geometry/material_point.h"

#include <Eigen/LU>
#include <algorithm>

namespace skerry {

MaterialPoint point_of_tetrahedron(std::span<const Vec3> nodes, const std::array<Index, 4>& corners,
                                   const Vec3& place) {
    const auto at = [&](std::size_t k) -> const Vec3& { return nodes[static_cast<std::size_t>(corners[k])]; };
    Mat3 edges;
    for (std::size_t k = 0; k < 3; ++k) edges.col(static_cast<Eigen::Index>(k)) = at(k + 1) - at(0);
    const Vec3 weight = edges.inverse() * (place - at(0));
    return {corners, {1 - weight.sum(), weight.x(), weight.y(), weight.z()}};
}

std::optional<MaterialPoint> point_inside(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& place) {
    // Tolerance for rounding errors of barycentric coordinates. With it a point on a shared face always belongs to the
    // first of the two tetrahedra.
    constexpr Real rounding = 1e-9;
    for (const std::array<Index, 4>& corners : tetrahedra) {
        const MaterialPoint point = point_of_tetrahedron(nodes, corners, place);
        if (std::ranges::all_of(point.weight, [](Real weight) { return weight >= -rounding; })) return point;
    }
    return {};
}

}  // namespace skerry
