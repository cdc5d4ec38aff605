#include "engine/mesh/manifold_fault.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "components/union_find.h"

namespace skerry::mesh {

namespace {

/// An edge of a boundary triangle: its two nodes, and the triangle corners at these nodes. Corners are numbered three
/// per triangle.
struct Side {
    std::array<Index, 2> node;    // node numbers in ascending order
    std::array<Index, 2> corner;  // triangle corners at the two nodes, in the order of `node`
};

std::vector<Side> sides_of(std::span<const BoundaryTriangle> boundary) {
    std::vector<Side> sides;
    sides.reserve(3 * boundary.size());
    for (std::size_t t = 0; t < boundary.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            Side side{{boundary[t].node[k], boundary[t].node[next]},
                      {static_cast<Index>(3 * t + k), static_cast<Index>(3 * t + next)}};
            if (side.node[0] > side.node[1]) {
                std::swap(side.node[0], side.node[1]);
                std::swap(side.corner[0], side.corner[1]);
            }
            sides.push_back(side);
        }
    std::ranges::sort(sides, {}, [](const Side& side) { return std::pair(side.node, side.corner); });
    return sides;
}

}  // namespace

std::size_t count_parts(const Mesh& mesh) {
    UnionFind parts;
    parts.start(mesh.nodes.size());
    for (const std::array<Index, 4>& t : mesh.tetrahedra)
        for (const Index n : t) parts.join(t[0], n);
    for (const std::array<Index, 3>& t : mesh.triangles)
        for (const Index n : t) parts.join(t[0], n);
    for (const std::array<Index, 4>& t : mesh.tetrahedra) parts.number(t[0]);
    for (const std::array<Index, 3>& t : mesh.triangles) parts.number(t[0]);
    return static_cast<std::size_t>(parts.number_count);
}

std::string open_edge(std::span<const BoundaryTriangle> surface) {
    const std::vector<Side> sides = sides_of(surface);
    std::string fault;  // the first one
    std::size_t count = 0;
    for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
        std::array<std::size_t, 2> in_direction{};
        for (; last < sides.size() && sides[last].node == sides[first].node; ++last) {
            const auto [low, high] = sides[last].corner;
            ++in_direction[low % 3 == (high + 1) % 3 ? 1 : 0];
        }
        if (in_direction[0] != in_direction[1] && count++ == 0)
            fault = "an edge between nodes " + std::to_string(sides[first].node[0]) + " and " +
                    std::to_string(sides[first].node[1]) + " that " + std::to_string(in_direction[0]) +
                    (in_direction[0] == 1 ? " triangle has" : " triangles have") + " in one direction and " +
                    std::to_string(in_direction[1]) + " in the other";
    }
    return count > 1 ? fault + " (" + std::to_string(count) + " such edges in total)" : fault;
}

std::string manifold_fault(std::span<const BoundaryTriangle> boundary) {
    if (boundary.empty()) return "no boundary triangle";
    const std::vector<Side> sides = sides_of(boundary);
    UnionFind rings;
    rings.start(3 * boundary.size());
    std::string fault;  // the first one
    std::size_t count = 0;
    const auto counted = [&](const char* faults) {
        return count > 1 ? fault + " (" + std::to_string(count) + " such " + faults + " in total)" : fault;
    };
    for (std::size_t first = 0; first < sides.size();) {
        std::size_t last = first;
        while (last < sides.size() && sides[last].node == sides[first].node) ++last;
        if (last - first == 2)
            for (std::size_t end = 0; end < 2; ++end)
                rings.join(sides[first].corner[end], sides[first + 1].corner[end]);
        else if (count++ == 0)
            fault = "an edge between nodes " + std::to_string(sides[first].node[0]) + " and " +
                    std::to_string(sides[first].node[1]) + " with " + std::to_string(last - first) +
                    " boundary triangles instead of 2";
        first = last;
    }
    if (count > 0) return counted("edges");
    // All corners at a node must belong to one ring of triangles. It is enough to compare each corner with the previous
    // corner of the same node.
    std::vector<std::pair<Index, Index>> corners;
    for (std::size_t c = 0; c < 3 * boundary.size(); ++c)
        corners.emplace_back(boundary[c / 3].node[c % 3], rings.root(static_cast<Index>(c)));
    std::ranges::sort(corners);
    for (std::size_t c = 1; c < corners.size(); ++c)
        if (corners[c].first == corners[c - 1].first && corners[c].second != corners[c - 1].second && count++ == 0)
            fault = "node " + std::to_string(corners[c].first) +
                    ", at which parts of the boundary meet without a common edge";
    return counted("meetings");
}

}  // namespace skerry::mesh
