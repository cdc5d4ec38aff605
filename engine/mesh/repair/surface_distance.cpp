#include "engine/mesh/repair/surface_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/mesh/repair/surface_measures.h"
#include "engine/mesh/repair/triangle_tree.h"

namespace skerry::mesh {

namespace {

Real longest_edge(const std::array<Vec3, 3>& x) {
    return std::max({(x[1] - x[0]).norm(), (x[2] - x[1]).norm(), (x[0] - x[2]).norm()});
}

/// Largest and mean distance from the points of one surface to the other surface [m].
struct OneSidedDistance {
    Real largest = 0, mean = 0;
};

OneSidedDistance distance_of(const SurfaceMesh& measured, const SurfaceMesh& target) {
    constexpr Real intervals_of_mean_edge = 8;
    // upper limit of the number of intervals per edge; it gives at most 2,145 sample points per triangle
    constexpr int most_intervals = 64;
    // Approximate upper limit of the number of sample points of a surface. A surface with very many triangles gets
    // fewer points per triangle.
    constexpr Real most_points = 3e6;
    const TriangleTree tree(target);
    const Real mean = mean_edge(measured), area = area_of(measured);
    const Real affordable_intervals = std::sqrt(2 * most_points / static_cast<Real>(measured.triangles.size()));
    std::vector<Vec3> points;
    OneSidedDistance found;
    for (const std::array<Index, 3>& t : measured.triangles) {
        const std::array<Vec3, 3> x = corners(measured, t);
        points.clear();
        const Real relative_length = mean > 0 ? longest_edge(x) / mean : 0;
        const Real intervals = std::ceil(std::min(intervals_of_mean_edge, affordable_intervals) * relative_length);
        sample_triangle(x, static_cast<int>(std::clamp<Real>(intervals, 1, most_intervals)), points);
        Real sum = 0;
        for (const Vec3& point : points) {
            const Real distance = std::sqrt(tree.distance_squared(point));
            found.largest = std::max(found.largest, distance);
            sum += distance;
        }
        const Real area_of_triangle = (x[1] - x[0]).cross(x[2] - x[0]).norm() / 2;
        if (area > 0) found.mean += sum / static_cast<Real>(points.size()) * area_of_triangle / area;
    }
    return found;
}

}  // namespace

void sample_triangle(const std::array<Vec3, 3>& corner, int intervals, std::vector<Vec3>& points) {
    for (int i = 0; i <= intervals; ++i)
        for (int j = 0; i + j <= intervals; ++j)
            points.push_back(((intervals - i - j) * corner[0] + i * corner[1] + j * corner[2]) / intervals);
}

SurfaceDistance surface_distance(const SurfaceMesh& first, const SurfaceMesh& second) {
    const OneSidedDistance from_first = distance_of(first, second), from_second = distance_of(second, first);
    return {from_first.largest, from_second.largest, from_first.mean, from_second.mean};
}

}  // namespace skerry::mesh
