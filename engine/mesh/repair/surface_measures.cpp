#include "engine/mesh/repair/surface_measures.h"

#include <Eigen/Geometry>

namespace skerry::mesh {

std::array<Vec3, 3> corners(const SurfaceMesh& surface, const std::array<Index, 3>& triangle) {
    return {surface.nodes[static_cast<std::size_t>(triangle[0])], surface.nodes[static_cast<std::size_t>(triangle[1])],
            surface.nodes[static_cast<std::size_t>(triangle[2])]};
}

Real mean_edge(const SurfaceMesh& surface) {
    Real sum = 0;
    for (const std::array<Index, 3>& t : surface.triangles) {
        const std::array<Vec3, 3> x = corners(surface, t);
        for (std::size_t a = 0; a < 3; ++a) sum += (x[(a + 1) % 3] - x[a]).norm();
    }
    return sum / static_cast<Real>(3 * surface.triangles.size());
}

Real area_of(const SurfaceMesh& surface) {
    Real area = 0;
    for (const std::array<Index, 3>& t : surface.triangles) {
        const std::array<Vec3, 3> x = corners(surface, t);
        area += (x[1] - x[0]).cross(x[2] - x[0]).norm() / 2;
    }
    return area;
}

Real volume_inside(const SurfaceMesh& surface) {
    Real volume = 0;
    for (const std::array<Index, 3>& t : surface.triangles) {
        std::array<Vec3, 3> x = corners(surface, t);
        for (Vec3& corner : x) corner -= surface.nodes.front();
        volume += x[0].dot(x[1].cross(x[2])) / 6;
    }
    return volume;
}

Real box_diagonal(const SurfaceMesh& surface) {
    if (surface.nodes.empty()) return 0;
    Vec3 lower = surface.nodes.front(), upper = lower;
    for (const Vec3& node : surface.nodes) {
        lower = lower.cwiseMin(node);
        upper = upper.cwiseMax(node);
    }
    return (upper - lower).norm();
}

}  // namespace skerry::mesh
