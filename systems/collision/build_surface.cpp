#include "systems/collision/build_surface.h"

#include <algorithm>
#include <utility>

#include "components/counting_sort.h"

namespace skerry {

namespace {

Index rows(std::size_t count) {
    return static_cast<Index>(count);
}

// Corners of the faces of a tetrahedron with positive volume. They are counter-clockwise as seen from outside. Face k
// is opposite to corner k.
constexpr std::array<std::array<std::size_t, 3>, 4> face_corner{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

std::array<Index, 2> edge_nodes(const std::array<Index, 3>& node, std::size_t k) {
    const Index a = node[k], b = node[(k + 1) % 3];
    return {std::min(a, b), std::max(a, b)};
}

/// True if side k of a triangle is an edge of the surface. In the degenerate triangle that stores the core of a round
/// body (TriangleTable), only side 0 can be an edge: the axis of a capsule.
bool has_edge(const std::array<Index, 3>& node, std::size_t k) {
    return !is_core(node) || (k == 0 && node[0] != node[1]);
}

/// Returns the highest node number of the triangles plus one.
Index end_of(std::span<const BoundaryTriangle> triangles) {
    Index end = 0;
    for (const BoundaryTriangle& triangle : triangles)
        for (const Index n : triangle.node) end = std::max(end, n + 1);
    return end;
}

/// Nodes of the boundary surface of a body. `node`: their numbers, ascending. `index_of`: for each node of the body,
/// its index in `node`, or no_index for an inner node.
struct BoundaryNodes {
    std::vector<Index> node, index_of;

    BoundaryNodes(std::span<const BoundaryTriangle> triangles, Index end)
        : index_of(static_cast<std::size_t>(end), no_index) {
        for (const BoundaryTriangle& triangle : triangles)
            for (const Index n : triangle.node) index_of[static_cast<std::size_t>(n)] = 0;
        for (Index n = 0; n < end; ++n) {
            if (index_of[static_cast<std::size_t>(n)] == no_index) continue;
            index_of[static_cast<std::size_t>(n)] = rows(node.size());
            node.push_back(n);
        }
    }
};

/// Edges of the boundary surface of a body. `node`: the lower and the higher node of each edge; edges are sorted by
/// these nodes.
struct BoundaryEdges {
    std::vector<std::array<Index, 2>> node;
    // For each triangle and side: index of the edge in `node`; no_index if the side is not an edge.
    std::vector<std::array<Index, 3>> triangle_edges;

    BoundaryEdges(std::span<const BoundaryTriangle> triangles, Index end)
        : triangle_edges(triangles.size(), {no_index, no_index, no_index}) {
        struct Side {
            std::array<Index, 2> node;
            Index triangle, k;
        };
        std::vector<Side> sides;
        sides.reserve(3 * triangles.size());
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k)
                if (has_edge(triangles[t].node, k))
                    sides.push_back({edge_nodes(triangles[t].node, k), rows(t), static_cast<Index>(k)});
        std::vector<Side> buffer;
        for (const std::size_t i : {1, 0})
            counting_sort(sides, buffer, end, [i](const Side& side) { return side.node[i]; });
        for (const Side& side : sides) {
            if (node.empty() || node.back() != side.node) node.push_back(side.node);
            triangle_edges[static_cast<std::size_t>(side.triangle)][static_cast<std::size_t>(side.k)] =
                rows(node.size()) - 1;
        }
    }
};

void append_vertices(const std::vector<Index>& node, Range triangles, Index first_vertex, Index first_node,
                     SurfaceTables& surface) {
    std::vector<Index> count(node.size() + 1, 0);
    for (Index t = triangles.begin; t < triangles.end; ++t)
        for (Index v : surface.triangles.vertex[t]) ++count[v - first_vertex + 1];
    for (std::size_t i = 1; i < count.size(); ++i) count[i] += count[i - 1];
    const Index base = rows(surface.vertex_triangle.size());
    for (std::size_t i = 0; i < node.size(); ++i) {
        surface.vertices.node.push_back(first_node + node[i]);
        surface.vertices.triangle_begin.push_back(base + count[i]);
        surface.vertices.triangle_end.push_back(base + count[i + 1]);
    }
    surface.vertex_triangle.resize(surface.vertex_triangle.size() + static_cast<std::size_t>(count.back()), no_index);
    for (Index t = triangles.begin; t < triangles.end; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index v = surface.triangles.vertex[t][k];
            Index& fill = count[v - first_vertex];
            if (base + fill == surface.vertices.triangle_begin[v])
                surface.triangles.owned_vertices[t] |= std::uint8_t(1u << k);
            surface.vertex_triangle[base + fill++] = t;
        }
}

void append_edges(const std::vector<std::array<Index, 2>>& node, Range triangles, Index first_node,
                  SurfaceTables& surface) {
    for (const auto& e : node) {
        surface.edges.node.push_back({first_node + e[0], first_node + e[1]});
        surface.edges.triangle.push_back({no_index, no_index});
    }
    for (Index t = triangles.begin; t < triangles.end; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            if (!has_edge(surface.triangles.node[t], k)) continue;
            auto& around = surface.edges.triangle[surface.triangles.edge[t][k]];
            if (around[0] == no_index) {
                around[0] = t;
                surface.triangles.owned_edges[t] |= std::uint8_t(1u << k);
            } else if (around[1] == no_index) {
                around[1] = t;
            }
        }
}

}  // namespace

std::vector<TetrahedronFace> sorted_faces(std::span<const std::array<Index, 4>> tetrahedra) {
    std::vector<TetrahedronFace> faces;
    faces.reserve(4 * tetrahedra.size());
    Index end = 0;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        for (std::size_t k = 0; k < 4; ++k) {
            TetrahedronFace face{{}, rows(t), static_cast<std::uint8_t>(k), false};
            for (std::size_t i = 0; i < 3; ++i) face.node[i] = tetrahedra[t][face_corner[k][i]];
            for (const auto& [low, high] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})
                if (Index& a = face.node[static_cast<std::size_t>(low)], &b = face.node[static_cast<std::size_t>(high)];
                    a > b) {
                    std::swap(a, b);
                    face.turned = !face.turned;
                }
            end = std::max(end, face.node[2] + 1);
            faces.push_back(face);
        }
    std::vector<TetrahedronFace> buffer;
    for (const std::size_t i : {2, 1, 0})
        counting_sort(faces, buffer, end, [i](const TetrahedronFace& face) { return face.node[i]; });
    return faces;
}

std::vector<BoundaryTriangle> boundary_triangles(std::span<const std::array<Index, 4>> tetrahedra) {
    const std::vector<TetrahedronFace> faces = sorted_faces(tetrahedra);
    // For face k of tetrahedron t, at index 4 t + k: 1 for a boundary face.
    std::vector<std::uint8_t> is_single(faces.size(), 0);
    for (std::size_t i = 0; i < faces.size();) {
        std::size_t end = i + 1;
        while (end < faces.size() && faces[end].node == faces[i].node) ++end;
        if (end == i + 1) is_single[4 * static_cast<std::size_t>(faces[i].tetrahedron) + faces[i].corner] = 1;
        i = end;
    }

    std::vector<BoundaryTriangle> triangles;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        for (std::size_t k = 0; k < 4; ++k) {
            if (!is_single[4 * t + k]) continue;
            const auto& corner = face_corner[k];
            const auto& node = tetrahedra[t];
            triangles.push_back({{node[corner[0]], node[corner[1]], node[corner[2]]}, rows(t)});
        }
    return triangles;
}

SurfaceRanges append_surface(std::span<const BoundaryTriangle> triangles, Index first_node, Index first_element,
                             SurfaceTables& surface) {
    const Index end = end_of(triangles);
    const BoundaryNodes nodes(triangles, end);
    const BoundaryEdges edges(triangles, end);

    SurfaceRanges ranges;
    ranges.triangles = {rows(surface.triangles.node.size()), rows(surface.triangles.node.size() + triangles.size())};
    ranges.edges = {rows(surface.edges.node.size()), rows(surface.edges.node.size() + edges.node.size())};
    ranges.vertices = {rows(surface.vertices.node.size()), rows(surface.vertices.node.size() + nodes.node.size())};

    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const BoundaryTriangle& triangle = triangles[t];
        std::array<Index, 3> node, edge_row, vertex_row;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index edge = edges.triangle_edges[t][k];
            node[k] = first_node + triangle.node[k];
            edge_row[k] = edge == no_index ? no_index : ranges.edges.begin + edge;
            vertex_row[k] = ranges.vertices.begin + nodes.index_of[static_cast<std::size_t>(triangle.node[k])];
        }
        surface.triangles.node.push_back(node);
        surface.triangles.edge.push_back(edge_row);
        surface.triangles.vertex.push_back(vertex_row);
        surface.triangles.owned_vertices.push_back(0);
        surface.triangles.owned_edges.push_back(0);
        surface.triangles.element.push_back(first_element == no_index ? no_index : first_element + triangle.element);
    }
    append_vertices(nodes.node, ranges.triangles, ranges.vertices.begin, first_node, surface);
    append_edges(edges.node, ranges.triangles, first_node, surface);
    return ranges;
}

SurfaceRanges append_surface_copy(const SurfaceRanges& original, RowOffsets& offset, SurfaceTables& surface) {
    const auto after = [](const auto& column, Range rows) {
        const Index begin = static_cast<Index>(column.size());
        return Range{begin, begin + rows.size()};
    };
    const SurfaceRanges ranges{after(surface.triangles.node, original.triangles),
                               after(surface.edges.node, original.edges),
                               after(surface.vertices.node, original.vertices)};
    offset.triangles = ranges.triangles.begin - original.triangles.begin;
    offset.edges = ranges.edges.begin - original.edges.begin;
    offset.vertices = ranges.vertices.begin - original.vertices.begin;
    append_copies(surface.triangles.node, original.triangles, [&](auto& rows) { add_offset(rows, offset.nodes); });
    append_copies(surface.triangles.edge, original.triangles, [&](auto& rows) { add_offset(rows, offset.edges); });
    append_copies(surface.triangles.vertex, original.triangles, [&](auto& rows) { add_offset(rows, offset.vertices); });
    append_copies(surface.triangles.owned_vertices, original.triangles, [](std::uint8_t) {});
    append_copies(surface.triangles.owned_edges, original.triangles, [](std::uint8_t) {});
    append_copies(surface.triangles.element, original.triangles, [&](Index& row) { add_offset(row, offset.elements); });
    append_copies(surface.edges.node, original.edges, [&](auto& rows) { add_offset(rows, offset.nodes); });
    append_copies(surface.edges.triangle, original.edges, [&](auto& rows) { add_offset(rows, offset.triangles); });
    if (original.vertices.size() == 0) return ranges;
    const Range around{surface.vertices.triangle_begin[original.vertices.begin],
                       surface.vertices.triangle_end[original.vertices.end - 1]};
    const Index items = static_cast<Index>(surface.vertex_triangle.size()) - around.begin;
    append_copies(surface.vertices.node, original.vertices, [&](Index& row) { add_offset(row, offset.nodes); });
    append_copies(surface.vertices.triangle_begin, original.vertices, [&](Index& index) { index += items; });
    append_copies(surface.vertices.triangle_end, original.vertices, [&](Index& index) { index += items; });
    append_copies(surface.vertex_triangle, around, [&](Index& row) { add_offset(row, offset.triangles); });
    return ranges;
}

}  // namespace skerry
