#include "engine/output/series/follow_point.h"

#include <Eigen/LU>
#include <utility>

namespace skerry {

std::pair<Index, Real> nearest_node(std::span<const Vec3> nodes, const Vec3& place) {
    std::pair<Index, Real> nearest{no_index, infinity};
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Real distance = (nodes[n] - place).norm();
        if (distance < nearest.second) nearest = {static_cast<Index>(n), distance};
    }
    return nearest;
}

std::optional<MaterialPoint> follow_point(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& place, Real reach) {
    // Tolerance for rounding errors of barycentric coordinates. With it a point on a shared face always belongs to the
    // first of the two tetrahedra.
    constexpr Real rounding = 1e-9;
    for (const auto& corner : tetrahedra) {
        const auto at = [&](std::size_t k) -> const Vec3& { return nodes[static_cast<std::size_t>(corner[k])]; };
        Mat3 edges;
        for (std::size_t k = 0; k < 3; ++k) edges.col(static_cast<Eigen::Index>(k)) = at(k + 1) - at(0);
        const Vec3 weight = edges.inverse() * (place - at(0));
        const Real first = 1 - weight.sum();
        if (first >= -rounding && (weight.array() >= -rounding).all())
            return MaterialPoint{corner, {first, weight.x(), weight.y(), weight.z()}};
    }
    const auto [node, distance] = nearest_node(nodes, place);
    if (!(distance <= reach)) return {};
    return MaterialPoint{{node, node, node, node}, {1, 0, 0, 0}};
}

}  // namespace skerry
