#include "engine/mesh/surface/crossings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "engine/mesh/repair/surface_measures.h"
#include "engine/mesh/surface/add_fault.h"
#include "engine/mesh/surface/triangle_boxes.h"
#include "systems/collision/tree/box_tree.h"
#include "systems/geometry/passes_through.h"

namespace skerry::mesh {
namespace {

using Points = std::array<Vec3, 3>;

struct Extent {
    Real low, high;
};

Extent extent_of(const Points& triangle, const Vec3& axis) {
    const Real a = axis.dot(triangle[0]), b = axis.dot(triangle[1]), c = axis.dot(triangle[2]);
    return {std::min({a, b, c}), std::max({a, b, c})};
}

/// Overlap of the projections of two triangles on a unit vector; negative if there is a gap [m].
Real overlap_along(const Points& first, const Points& second, const Vec3& axis) {
    const Extent a = extent_of(first, axis), b = extent_of(second, axis);
    return std::min(a.high - b.low, b.high - a.low);
}

Points sides_of(const Points& x) {
    return {x[1] - x[0], x[2] - x[1], x[0] - x[2]};
}

Real longest_side(const Points& sides) {
    return std::sqrt(std::max({sides[0].squaredNorm(), sides[1].squaredNorm(), sides[2].squaredNorm()}));
}

/// Smallest altitude of a triangle, which is perpendicular to its longest side [m].
Real least_altitude(const Points& x) {
    const Points sides = sides_of(x);
    const Real length = longest_side(sides);
    return length > 0 ? sides[0].cross(sides[1]).norm() / length : 0;
}

enum class PairFault { none, crossing, overlap };

/// Tests whether two triangles cross, or overlap in one plane, by separating axes (Gottschalk, Lin, Manocha 1996): two
/// convex shapes are apart if and only if their projections on at least one of certain axes are apart. Triangles that
/// share only a corner or an edge do not overlap, because on some axis their projections only touch.
///
/// `tolerance`: largest overlap that counts as rounding error [m].
PairFault fault_of(const Points& first, const Points& second, Real tolerance) {
    // Smallest sine of the angle between two sides, |a x b| / (|a| |b|), for which the direction of a x b is reliable.
    constexpr Real parallel = 1e-9;
    const Points u = sides_of(first), v = sides_of(second);
    const Vec3 normal = u[0].cross(u[1]).normalized(), other = v[0].cross(v[1]).normalized();
    const auto separates = [&](const Vec3& axis) { return overlap_along(first, second, axis) <= tolerance; };
    const Real height = overlap_along(first, second, normal);
    if (height < -tolerance) return PairFault::none;
    if (height > tolerance) {
        if (separates(other)) return PairFault::none;
        for (const Vec3& a : u)
            for (const Vec3& b : v) {
                const Vec3 axis = a.cross(b);
                const Real length = axis.norm();
                if (length > parallel * a.norm() * b.norm() && separates(axis / length)) return PairFault::none;
            }
        return PairFault::crossing;
    }
    const Extent heights = extent_of({second[0] - first[0], second[1] - first[0], second[2] - first[0]}, normal);
    if (heights.high - heights.low > 2 * tolerance) return PairFault::none;
    for (const Points& sides : {u, v})
        for (const Vec3& side : sides)
            if (separates(normal.cross(side).normalized())) return PairFault::none;
    return PairFault::overlap;
}

/// Length of a ray that starts at `origin`, a point of the triangle `start_triangle`, and ends at the first triangle
/// that shares no node with `start_triangle`. Not more than `limit` [m].
Real free_path(const SurfaceMesh& surface, const BoxTree& tree, Index start_triangle, const Vec3& origin,
               const Vec3& direction, Real limit) {
    Real nearest = limit;
    const auto meets = [&](const Aabb& box) {
        Real enter = 0, leave = nearest;
        for (int i = 0; i < 3; ++i) {
            const Real low = (box.lower[i] - origin[i]) / direction[i],
                       high = (box.upper[i] - origin[i]) / direction[i];
            enter = std::max(enter, std::min(low, high));
            leave = std::min(leave, std::max(low, high));
        }
        return enter <= leave;
    };
    const std::array<Index, 3>& own = surface.triangles[static_cast<std::size_t>(start_triangle)];
    tree.for_each(meets, [&](Index t) {
        const std::array<Index, 3>& nodes = surface.triangles[static_cast<std::size_t>(t)];
        if (std::ranges::find_first_of(nodes, own) != nodes.end()) return;
        const auto [a, b, c] = corners_of(surface, t);
        if (!passes_through(origin, origin + nearest * direction, a, b, c)) return;
        const Vec3 normal = (b - a).cross(c - a);
        nearest = std::clamp(normal.dot(a - origin) / normal.dot(direction), Real(0), nearest);
    });
    return nearest;
}

}  // namespace

void find_crossings(SurfaceReport& report, Real distance) {
    const SurfaceMesh& surface = report.cleaned;
    const std::vector<Aabb> boxes = triangle_boxes(surface, distance / 2);
    const BoxTree tree(boxes);
    std::vector<Index> pairs;
    for (std::size_t t = 0; t < boxes.size(); ++t) {
        const auto first = static_cast<Index>(t);
        const Points corners = corners_of(surface, first);
        if (least_altitude(corners) <= distance) {
            add_fault(report, SurfaceFaultKind::slivers, first);
            continue;
        }
        pairs.clear();
        tree.for_each_overlap(boxes[t], [&](Index other) {
            if (other > first) pairs.push_back(other);
        });
        std::ranges::sort(pairs);
        for (const Index other : pairs) {
            const Points others = corners_of(surface, other);
            if (least_altitude(others) <= distance) continue;
            const PairFault fault = fault_of(corners, others, distance);
            if (fault == PairFault::none) continue;
            const auto row = static_cast<std::size_t>(other);
            const Vec3 place =
                (boxes[t].lower.cwiseMax(boxes[row].lower) + boxes[t].upper.cwiseMin(boxes[row].upper)) / 2;
            add_fault(report,
                      fault == PairFault::overlap            ? SurfaceFaultKind::overlaps
                      : report.shell[t] == report.shell[row] ? SurfaceFaultKind::crossings
                                                             : SurfaceFaultKind::shell_crossings,
                      first, place, other);
        }
    }
}

void find_thin_walls(SurfaceReport& report) {
    constexpr std::size_t samples = 500;
    constexpr Real thin = 0.5;  // largest thickness of a thin wall, relative to the mean edge
    const SurfaceMesh& surface = report.cleaned;
    const BoxTree tree(triangle_boxes(surface, 0));
    const std::size_t stride = std::max<std::size_t>(1, surface.triangles.size() / samples);
    for (std::size_t t = 0; t < surface.triangles.size(); t += stride) {
        if (!report.shells[static_cast<std::size_t>(report.shell[t])].closed) continue;
        const auto [a, b, c] = corners_of(surface, static_cast<Index>(t));
        const Vec3 inward = (c - a).cross(b - a).normalized();
        if (inward.isZero()) continue;
        const Real limit = thin * report.mean_edge;
        const Real thickness = free_path(surface, tree, static_cast<Index>(t), (a + b + c) / 3, inward, limit);
        if (thickness >= limit) continue;
        SurfaceFault& fault = add_fault(report, SurfaceFaultKind::thin_walls, static_cast<Index>(t));
        fault.length = fault.count == 1 ? thickness : std::min(fault.length, thickness);
    }
}

}  // namespace skerry::mesh
