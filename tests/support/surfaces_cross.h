// Brute-force test for intersecting surfaces: every edge against every triangle.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>

#include "components/types.h"

namespace skerry::test {

struct SurfaceView {
    std::span<const Vec3> position;
    std::span<const std::array<Index, 3>> triangle;

    const Vec3& at(Index node) const { return position[static_cast<std::size_t>(node)]; }
};

/// Six times the volume of a tetrahedron; its sign tells on which side of abc the point d lies.
inline Real orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
}

/// True if the interior of segment pq passes through the interior of triangle abc; touching does not count.
inline bool passes_through(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    for (int i = 0; i < 3; ++i) {
        if (std::max(p[i], q[i]) < std::min({a[i], b[i], c[i]}) || std::min(p[i], q[i]) > std::max({a[i], b[i], c[i]}))
            return false;
    }
    if (!(orientation(a, b, c, p) * orientation(a, b, c, q) < 0)) return false;
    const Real u = orientation(p, q, a, b), v = orientation(p, q, b, c), w = orientation(p, q, c, a);
    return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

/// Number of pairs of an edge of one surface and a triangle of the other that intersect, for both orders of surfaces.
inline int crossings(const SurfaceView& first, const SurfaceView& second) {
    int count = 0;
    const auto edges_through = [&count](const SurfaceView& edges, const SurfaceView& faces) {
        for (const auto& e : edges.triangle)
            for (std::size_t k = 0; k < 3; ++k) {
                if (e[k] > e[(k + 1) % 3]) continue;  // a closed surface has each edge twice, once in either direction
                for (const auto& f : faces.triangle)
                    count += passes_through(edges.at(e[k]), edges.at(e[(k + 1) % 3]), faces.at(f[0]), faces.at(f[1]),
                                            faces.at(f[2]));
            }
    };
    edges_through(first, second);
    edges_through(second, first);
    return count;
}

/// Number of intersecting pairs of an edge and a triangle of one surface. Pairs that share a node are left out because
/// their intersection cannot be told from the shared node.
inline int self_crossings(const SurfaceView& surface) {
    int count = 0;
    for (const auto& e : surface.triangle)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index p = e[k], q = e[(k + 1) % 3];
            if (p > q) continue;
            for (const auto& f : surface.triangle) {
                const bool shared = f[0] == p || f[1] == p || f[2] == p || f[0] == q || f[1] == q || f[2] == q;
                if (!shared)
                    count += passes_through(surface.at(p), surface.at(q), surface.at(f[0]), surface.at(f[1]),
                                            surface.at(f[2]));
            }
        }
    return count;
}

}  // namespace skerry::test
