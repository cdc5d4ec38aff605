#include "systems/collision/build_surface.h"

#include <algorithm>

namespace skerry {

namespace {

Index rows(std::size_t count) {
    return static_cast<Index>(count);
}

struct Face {
    std::array<Index, 3> sorted;
    Index element;
    Index corner;  // the one it lies opposite of
};

// Faces of a tetrahedron of positive volume, counter-clockwise seen from outside; face k lies opposite of corner k.
constexpr std::array<std::array<std::size_t, 3>, 4> face_corner{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

std::array<Index, 2> edge_nodes(const std::array<Index, 3>& node, std::size_t k) {
    const Index a = node[k], b = node[(k + 1) % 3];
    return {std::min(a, b), std::max(a, b)};
}

/// Whether side k is an edge: of the core of a round body the first at most.
bool has_edge(const std::array<Index, 3>& node, std::size_t k) {
    return !is_core(node) || (k == 0 && node[0] != node[1]);
}

/// Rows of `sorted` start at `first`.
template <class T>
Index row_of(const std::vector<T>& sorted, const T& value, Index first) {
    return first + static_cast<Index>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

template <class T>
void keep_unique(std::vector<T>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

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

std::vector<BoundaryTriangle> boundary_triangles(std::span<const std::array<Index, 4>> tetrahedra) {
    std::vector<Face> faces;
    faces.reserve(4 * tetrahedra.size());
    for (std::size_t e = 0; e < tetrahedra.size(); ++e)
        for (std::size_t k = 0; k < 4; ++k) {
            std::array<Index, 3> node;
            for (std::size_t i = 0; i < 3; ++i) node[i] = tetrahedra[e][face_corner[k][i]];
            std::sort(node.begin(), node.end());
            faces.push_back({node, rows(e), rows(k)});
        }
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.sorted < b.sorted; });

    std::vector<Face> single;
    for (std::size_t i = 0; i < faces.size();) {
        std::size_t end = i + 1;
        while (end < faces.size() && faces[end].sorted == faces[i].sorted) ++end;
        if (end == i + 1) single.push_back(faces[i]);
        i = end;
    }
    std::sort(single.begin(), single.end(), [](const Face& a, const Face& b) {
        return a.element != b.element ? a.element < b.element : a.corner < b.corner;
    });

    std::vector<BoundaryTriangle> triangles;
    triangles.reserve(single.size());
    for (const Face& face : single) {
        const auto& corner = face_corner[face.corner];
        const auto& node = tetrahedra[face.element];
        triangles.push_back({{node[corner[0]], node[corner[1]], node[corner[2]]}, face.element});
    }
    return triangles;
}

SurfaceRanges append_surface(std::span<const BoundaryTriangle> triangles, Index first_node, Index first_element,
                             SurfaceTables& surface) {
    std::vector<Index> vertex;
    std::vector<std::array<Index, 2>> edge;
    for (const BoundaryTriangle& triangle : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            vertex.push_back(triangle.node[k]);
            if (has_edge(triangle.node, k)) edge.push_back(edge_nodes(triangle.node, k));
        }
    keep_unique(vertex);
    keep_unique(edge);

    SurfaceRanges ranges;
    ranges.triangles = {rows(surface.triangles.node.size()), rows(surface.triangles.node.size() + triangles.size())};
    ranges.edges = {rows(surface.edges.node.size()), rows(surface.edges.node.size() + edge.size())};
    ranges.vertices = {rows(surface.vertices.node.size()), rows(surface.vertices.node.size() + vertex.size())};

    for (const BoundaryTriangle& triangle : triangles) {
        std::array<Index, 3> node, edge_row, vertex_row;
        for (std::size_t k = 0; k < 3; ++k) {
            node[k] = first_node + triangle.node[k];
            edge_row[k] =
                has_edge(triangle.node, k) ? row_of(edge, edge_nodes(triangle.node, k), ranges.edges.begin) : no_index;
            vertex_row[k] = row_of(vertex, triangle.node[k], ranges.vertices.begin);
        }
        surface.triangles.node.push_back(node);
        surface.triangles.edge.push_back(edge_row);
        surface.triangles.vertex.push_back(vertex_row);
        surface.triangles.owned_vertices.push_back(0);
        surface.triangles.owned_edges.push_back(0);
        surface.triangles.element.push_back(first_element == no_index ? no_index : first_element + triangle.element);
    }
    append_vertices(vertex, ranges.triangles, ranges.vertices.begin, first_node, surface);
    append_edges(edge, ranges.triangles, first_node, surface);
    return ranges;
}

}  // namespace skerry
