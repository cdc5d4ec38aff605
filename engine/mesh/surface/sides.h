// Sides of triangles, grouped by edges.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/types.h"
#include "components/union_find.h"

namespace skerry::mesh {

using Triangles = std::span<const std::array<Index, 3>>;

/// A side of a triangle. Side k of triangle t leads from its corner k to its next corner. Corner k of triangle t has
/// the number 3 t + k.
struct Side {
    std::array<Index, 2> node;    // node numbers in ascending order
    std::array<Index, 2> corner;  // corners of the triangle at node[0] and node[1]

    Index triangle() const { return corner[0] / 3; }
    /// True if the side leads from the lower to the higher node number.
    bool rises() const { return corner[1] % 3 == (corner[0] + 1) % 3; }
};

/// Sides of all triangles, sorted by their nodes. Sides with the same nodes are in the order of their triangles.
std::vector<Side> sorted_sides(Triangles triangles);

/// Calls visit(sides of one edge) for each edge.
void for_each_edge(std::span<const Side> sides, auto&& visit) {
    for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
        while (last < sides.size() && sides[last].node == sides[first].node) ++last;
        visit(sides.subspan(first, last - first));
    }
}

/// Joins in `fans` the corners of two triangles at the two ends of their common edge.
inline void join_corners(UnionFind& fans, const Side& a, const Side& b) {
    for (std::size_t end = 0; end < 2; ++end) fans.join(a.corner[end], b.corner[end]);
}

/// Finds nodes with several fans. A fan is a set of triangles around a node that are connected by edges at this node.
/// Returns one corner of each fan except the first fan of a node, in the order of the nodes. `fans`: result of
/// join_corners() for all common edges.
std::vector<Index> further_fans(Triangles triangles, UnionFind& fans);

}  // namespace skerry::mesh
