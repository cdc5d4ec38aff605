#include <algorithm>
#include <limits>
#include <utility>

#include "components/union_find.h"
#include "skerry/surface_check.h"

namespace skerry::mesh {
namespace {

/// Joins nodes that are up to `distance` apart. Only nodes that are within `distance` of each other along `direction`
/// are compared.
void join_close_nodes(std::span<const Vec3> nodes, Real distance, UnionFind& joined) {
    // The direction is not normal to the planes of usual grids: all nodes of such a plane would be compared.
    const Vec3 direction(0.41, 0.57, 0.71205);
    std::vector<std::pair<Real, Index>> along;
    along.reserve(nodes.size());
    Real largest = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        along.emplace_back(nodes[n].dot(direction), static_cast<Index>(n));
        largest = std::max(largest, nodes[n].cwiseAbs().maxCoeff());
    }
    std::ranges::sort(along);
    const Real thickness = distance + 8 * std::numeric_limits<Real>::epsilon() * largest;
    for (std::size_t i = 0; i < along.size(); ++i)
        for (std::size_t j = i + 1; j < along.size() && along[j].first - along[i].first <= thickness; ++j) {
            const Vec3 apart =
                nodes[static_cast<std::size_t>(along[j].second)] - nodes[static_cast<std::size_t>(along[i].second)];
            if (apart.squaredNorm() <= distance * distance) joined.join(along[i].second, along[j].second);
        }
}

}  // namespace

SurfaceMesh weld(const SurfaceMesh& surface, Real distance, std::vector<Index>* number) {
    UnionFind joined;
    joined.start(surface.nodes.size());
    if (distance >= 0) join_close_nodes(surface.nodes, distance, joined);
    SurfaceMesh welded;
    std::vector<bool> used(surface.nodes.size(), false);
    if (number) number->clear();
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        std::array<Index, 3> triangle = surface.triangles[t];
        for (Index& n : triangle) n = joined.root(n);
        if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
        for (const Index n : triangle) used[static_cast<std::size_t>(n)] = true;
        welded.triangles.push_back(triangle);
        if (number) number->push_back(static_cast<Index>(t));
    }
    std::vector<Index> row(surface.nodes.size(), no_index);
    for (std::size_t n = 0; n < row.size(); ++n) {
        if (!used[n]) continue;
        row[n] = static_cast<Index>(welded.nodes.size());
        welded.nodes.push_back(surface.nodes[n]);
    }
    for (std::array<Index, 3>& triangle : welded.triangles)
        for (Index& n : triangle) n = row[static_cast<std::size_t>(n)];
    return welded;
}

}  // namespace skerry::mesh
