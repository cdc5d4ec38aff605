#include "engine/mesh/repair/surface_distance.h"

#include <algorithm>
#include <cmath>

#include "engine/mesh/repair/triangle_tree.h"

namespace skerry::mesh {

namespace {

std::array<Vec3, 3> corners(const SurfaceMesh& surface, const std::array<Index, 3>& t) {
    return {surface.nodes[static_cast<std::size_t>(t[0])], surface.nodes[static_cast<std::size_t>(t[1])],
            surface.nodes[static_cast<std::size_t>(t[2])]};
}

Real longest_edge(const std::array<Vec3, 3>& x) {
    return std::max({(x[1] - x[0]).norm(), (x[2] - x[1]).norm(), (x[0] - x[2]).norm()});
}

Real mean_edge(const SurfaceMesh& surface) {
    Real sum = 0;
    for (const std::array<Index, 3>& t : surface.triangles) {
        const std::array<Vec3, 3> x = corners(surface, t);
        for (std::size_t a = 0; a < 3; ++a) sum += (x[(a + 1) % 3] - x[a]).norm();
    }
    return sum / static_cast<Real>(3 * surface.triangles.size());
}

Real greatest_distance(const SurfaceMesh& from, const SurfaceMesh& to) {
    constexpr Real parts_of_mean_edge = 8;
    // largest number of intervals per edge; it gives at most 2,145 sample points per triangle
    constexpr int most_parts = 64;
    const TriangleTree tree(to);
    const Real mean = mean_edge(from);
    std::vector<Vec3> points;
    Real greatest = 0;
    for (const std::array<Index, 3>& t : from.triangles) {
        const std::array<Vec3, 3> x = corners(from, t);
        points.clear();
        const Real parts = mean > 0 ? std::ceil(parts_of_mean_edge * longest_edge(x) / mean) : 1;
        sample_triangle(x, static_cast<int>(std::clamp<Real>(parts, 1, most_parts)), points);
        for (const Vec3& point : points) greatest = std::max(greatest, tree.distance_squared(point));
    }
    return std::sqrt(greatest);
}

}  // namespace

void sample_triangle(const std::array<Vec3, 3>& corner, int parts, std::vector<Vec3>& points) {
    for (int i = 0; i <= parts; ++i)
        for (int j = 0; i + j <= parts; ++j)
            points.push_back(((parts - i - j) * corner[0] + i * corner[1] + j * corner[2]) / parts);
}

SurfaceDistance surface_distance(const SurfaceMesh& first, const SurfaceMesh& second) {
    return {greatest_distance(first, second), greatest_distance(second, first)};
}

}  // namespace skerry::mesh
