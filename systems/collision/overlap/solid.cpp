#include "systems/collision/overlap/solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

/// True if every edge of the surface occurs equally often in both directions.
bool is_closed(std::span<const SolidTriangle> surface) {
    struct Side {
        std::array<Index, 2> node;  // ascending
        int direction;
    };
    std::vector<Side> sides;
    sides.reserve(3 * surface.size());
    for (const SolidTriangle& t : surface)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = t.node[k], b = t.node[(k + 1) % 3];
            sides.push_back({{std::min(a, b), std::max(a, b)}, a < b ? 1 : -1});
        }
    std::ranges::sort(sides, {}, &Side::node);
    int sum = 0;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        sum += sides[i].direction;
        if (i + 1 < sides.size() && sides[i + 1].node == sides[i].node) continue;
        if (sum != 0) return false;
    }
    return !sides.empty();
}

void finish(Solid& solid) {
    std::vector<Aabb> boxes(solid.simplex.size(), empty_box());
    solid.box = empty_box();
    for (std::size_t s = 0; s < boxes.size(); ++s) {
        for (const Index n : solid.simplex[s])
            if (n != no_index) grow(boxes[s], solid.point[static_cast<std::size_t>(n)]);
        grow(solid.box, boxes[s]);
    }
    solid.tree = BoxTree(boxes);
    for (const SolidTriangle& t : solid.surface)
        solid.surface_point.insert(solid.surface_point.end(), t.node.begin(), t.node.end());
    std::ranges::sort(solid.surface_point);
    solid.surface_point.erase(std::unique(solid.surface_point.begin(), solid.surface_point.end()),
                              solid.surface_point.end());
}

/// Side of the line from a to b on which a point lies, in the projection on the x-y plane: 1 is left, -1 is right. A
/// point on the line counts as shifted by an infinitesimal vector (e, e^2). So a vertical ray through an edge hits
/// exactly one of the two triangles at the edge.
int side_of(const Vec3& point, const Vec3& a, const Vec3& b) {
    const Real x = b.x() - a.x(), y = b.y() - a.y();
    const Real area = x * (point.y() - a.y()) - y * (point.x() - a.x());
    if (area != 0) return area > 0 ? 1 : -1;
    if (y != 0) return y < 0 ? 1 : -1;
    return x > 0 ? 1 : -1;
}

/// Returns 1 if a ray from the point in the direction z leaves the solid through the triangle, -1 if the ray enters the
/// solid, and 0 if the ray misses the triangle.
int passage(const Solid& solid, const std::array<Index, 4>& triangle, const Vec3& point) {
    const auto at = [&](std::size_t k) -> const Vec3& { return solid.point[static_cast<std::size_t>(triangle[k])]; };
    int side = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        // The node with the lower index comes first, so both triangles at an edge call side_of with the same arguments.
        // Their results then always have opposite signs, even if rounding errors decide the side.
        const int own =
            triangle[k] < triangle[next] ? side_of(point, at(k), at(next)) : -side_of(point, at(next), at(k));
        if (side != 0 && own != side) return 0;
        side = own;
    }
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    // The condition holds if the plane of the triangle is above the point, whatever the direction of `normal`.
    return normal.dot(at(0) - point) * normal.z() > 0 ? side : 0;
}

bool surface_contains(const Solid& solid, const Vec3& point) {
    int winding = 0;
    const auto above = [&](const Aabb& box) {
        return box.lower.x() <= point.x() && point.x() <= box.upper.x() && box.lower.y() <= point.y() &&
               point.y() <= box.upper.y() && point.z() <= box.upper.z();
    };
    solid.tree.for_each(above,
                        [&](Index s) { winding += passage(solid, solid.simplex[static_cast<std::size_t>(s)], point); });
    return winding > 0;
}

bool tetrahedron_contains(const Simplex& t, const Vec3& point, Real tolerance) {
    constexpr std::array<std::array<std::size_t, 4>, 4> face_and_corner{
        {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}}};
    for (const auto& [a, b, c, corner] : face_and_corner) {
        const Vec3 normal = (t.point[b] - t.point[a]).cross(t.point[c] - t.point[a]).normalized();
        const Real own = normal.dot(point - t.point[a]), inner = normal.dot(t.point[corner] - t.point[a]);
        if (!((inner > 0 ? own : -own) >= -tolerance)) return false;
    }
    return true;
}

}  // namespace

Simplex Solid::at(Index s) const {
    const std::array<Index, 4>& node = simplex[static_cast<std::size_t>(s)];
    Simplex found;
    found.count = has_volume ? 4 : 3;
    for (std::size_t k = 0; k < 4; ++k) found.point[k] = point[static_cast<std::size_t>(node[k < found.count ? k : 0])];
    return found;
}

Solid solid_of_tetrahedra(std::span<const Vec3> point, std::span<const std::array<Index, 4>> tetrahedra,
                          std::vector<SolidTriangle> surface) {
    Solid solid{};
    solid.point.assign(point.begin(), point.end());
    solid.simplex.assign(tetrahedra.begin(), tetrahedra.end());
    solid.surface = std::move(surface);
    solid.has_volume = solid.closed = true;
    finish(solid);
    return solid;
}

Solid solid_of_surface(std::span<const Vec3> point, std::span<const std::array<Index, 3>> triangles) {
    Solid solid{};
    solid.point.assign(point.begin(), point.end());
    for (const auto& [a, b, c] : triangles) {
        solid.surface.push_back({{a, b, c}, static_cast<Index>(solid.simplex.size())});
        solid.simplex.push_back({a, b, c, no_index});
    }
    solid.has_volume = false;
    solid.closed = is_closed(solid.surface);
    finish(solid);
    return solid;
}

bool contains(const Solid& solid, const Vec3& point, Real tolerance) {
    if (!solid.has_volume) return solid.closed && surface_contains(solid, point);
    bool inside = false;
    const Vec3 margin = Vec3::Constant(tolerance);
    const auto near = [&](const Aabb& box) {
        return !inside && ((box.lower - margin).array() <= point.array()).all() &&
               (point.array() <= (box.upper + margin).array()).all();
    };
    solid.tree.for_each(near, [&](Index s) { inside = inside || tetrahedron_contains(solid.at(s), point, tolerance); });
    return inside;
}

}  // namespace skerry
