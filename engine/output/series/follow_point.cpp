#include "engine/output/series/follow_point.h"

#include <utility>

namespace skerry {

std::pair<Index, Real> nearest_node(std::span<const Vec3> nodes, const Vec3& point) {
    std::pair<Index, Real> nearest{no_index, infinity};
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Real distance = (nodes[n] - point).norm();
        if (distance < nearest.second) nearest = {static_cast<Index>(n), distance};
    }
    return nearest;
}

std::optional<MaterialPoint> follow_point(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                                          const Vec3& point, Real reach) {
    if (tetrahedra.empty()) return point_of_solid(nodes, point);
    if (const std::optional<MaterialPoint> inside = point_inside(nodes, tetrahedra, point)) return inside;
    const auto [node, distance] = nearest_node(nodes, point);
    if (!(distance <= reach)) return {};
    return MaterialPoint{{node, node, node, node}, {1, 0, 0, 0}};
}

}  // namespace skerry
