#include "skerry/refine.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/mesh/formats/raw_mesh.h"
#include "engine/mesh/sets.h"
#include "engine/mesh/shapes/add_tetrahedron.h"
#include "engine/mesh/subdivision.h"
#include "engine/mesh/tetrahedron.h"

namespace skerry::mesh {
namespace {

/// A face of a tetrahedron: its corners, and its edges as indices into second_order_edges.
struct FaceOfTetrahedron {
    std::array<std::size_t, 3> corner, edge;
};
constexpr std::array<FaceOfTetrahedron, 4> faces_of_tetrahedron{
    {{{0, 1, 2}, {0, 1, 2}}, {{0, 1, 3}, {0, 4, 3}}, {{1, 2, 3}, {1, 5, 4}}, {{2, 0, 3}, {2, 3, 5}}}};

template <std::size_t N>
std::array<Index, 3> picked(const std::array<Index, N>& corners, const std::array<std::size_t, 3>& position) {
    return {corners[position[0]], corners[position[1]], corners[position[2]]};
}

/// Finds the new nodes that a set of nodes gains when the mesh is refined. The new nodes are the midpoints of edges. If
/// all corners of a face are in the set, so are all nodes of the smaller faces into which the refinement divides it.
/// add_edge() tells which edges outside of such faces also give their midpoints to the set.
class MidpointMarks {
public:
    MidpointMarks(std::size_t node_count, const std::vector<Index>& nodes) : in_set_(node_count), on_face_(node_count) {
        for (const Index n : nodes) in_set_[static_cast<std::size_t>(n)] = true;
    }

    void add_face(const std::array<Index, 3>& corners, const std::array<Index, 3>& midpoints) {
        if (!std::ranges::all_of(corners, [&](Index n) { return in_set_[static_cast<std::size_t>(n)]; })) return;
        for (const Index n : corners) on_face_[static_cast<std::size_t>(n)] = true;
        found_.insert(found_.end(), midpoints.begin(), midpoints.end());
    }
    /// Adds the midpoint of an edge with both ends in the set, unless both ends are nodes of faces in the set. A side
    /// of such a face has its midpoint from add_face(), and an edge that only connects two such faces needs none. Call
    /// add_face() for all faces first.
    void add_edge(std::size_t a, std::size_t b, Index midpoint) {
        if (in_set_[a] && in_set_[b] && !(on_face_[a] && on_face_[b])) found_.push_back(midpoint);
    }
    /// Returns the midpoints in ascending order.
    std::vector<Index> take() {
        std::ranges::sort(found_);
        found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
        return std::move(found_);
    }

private:
    std::vector<bool> in_set_, on_face_;  // on_face_: true for a node of a face that has all of its nodes in the set
    std::vector<Index> found_;
};

void require_refinable(const Mesh& mesh) {
    require_valid(mesh, "mesh");
    const auto require_one_each = [&](const std::string& field, std::size_t count) {
        if (count != mesh.tetrahedra.size())
            refuse("mesh", field, std::to_string(count) + " values",
                   std::to_string(mesh.tetrahedra.size()) + " values, one for each tetrahedron");
    };
    for (const std::array<Index, 3>& triangle : mesh.triangles)
        for (const Index n : triangle)
            if (n < 0 || n >= static_cast<Index>(mesh.nodes.size()))
                refuse("mesh", "triangles", "node " + std::to_string(n),
                       "the index of a node, below " + std::to_string(mesh.nodes.size()));
    if (!mesh.label.empty()) require_one_each("label", mesh.label.size());
    for (const auto& [name, vectors] : mesh.vectors) require_one_each("vectors[\"" + name + "\"]", vectors.size());
    for (const auto& [name, set] : mesh.sets)
        require_set("mesh", name, {.nodes = set.nodes, .faces = {}, .tetrahedra = set.tetrahedra}, mesh.nodes.size(),
                    mesh.tetrahedra);
    require_fits("mesh", "refine", 8.0 * static_cast<double>(mesh.tetrahedra.size() + mesh.triangles.size()));
}

}  // namespace

void add_midpoints(const Subdivision& subdivision, std::vector<Index>& nodes) {
    MidpointMarks marks(subdivision.node_count, nodes);
    for (std::size_t t = 0; t < subdivision.tetrahedra.size(); ++t)
        for (const FaceOfTetrahedron& face : faces_of_tetrahedron)
            marks.add_face(picked(subdivision.tetrahedra[t], face.corner), picked(subdivision.middle[t], face.edge));
    for (std::size_t t = 0; t < subdivision.triangles.size(); ++t)
        marks.add_face(subdivision.triangles[t], subdivision.triangle_middle[t]);
    const auto add_edges = [&](const auto& elements, const auto& middle) {
        for (std::size_t i = 0; i < elements.size(); ++i)
            for (std::size_t e = 0; e < middle[i].size(); ++e)
                marks.add_edge(static_cast<std::size_t>(elements[i][second_order_edges[e][0]]),
                               static_cast<std::size_t>(elements[i][second_order_edges[e][1]]), middle[i][e]);
    };
    add_edges(subdivision.tetrahedra, subdivision.middle);
    add_edges(subdivision.triangles, subdivision.triangle_middle);
    const std::vector<Index> midpoints = marks.take();
    nodes.insert(nodes.end(), midpoints.begin(), midpoints.end());
}

Subdivision subdivide(Mesh& mesh) {
    require_refinable(mesh);
    RawMesh raw;
    raw.nodes = std::move(mesh.nodes);
    raw.tetrahedra = std::move(mesh.tetrahedra);
    raw.label = std::move(mesh.label);
    raw.triangles = std::move(mesh.triangles);
    raw.sets = std::move(mesh.sets);
    raw.vectors = std::move(mesh.vectors);
    Subdivision before{.node_count = raw.nodes.size()};
    add_middle_nodes(raw);
    before.tetrahedra = raw.tetrahedra;
    before.middle = raw.middle;
    before.triangles = raw.triangles;
    before.triangle_middle = raw.triangle_middle;
    for (auto& [name, set] : raw.sets)
        if (!set.nodes.empty()) add_midpoints(before, set.nodes);
    divide_second_order(raw);
    mesh.nodes = std::move(raw.nodes);
    mesh.tetrahedra = std::move(raw.tetrahedra);
    mesh.label = std::move(raw.label);
    mesh.triangles = std::move(raw.triangles);
    mesh.sets = std::move(raw.sets);
    mesh.vectors = std::move(raw.vectors);
    if (!mesh.file_number.empty()) {
        const Index next = mesh.file_number.back() + 1;
        mesh.file_number.resize(mesh.nodes.size());
        std::iota(mesh.file_number.begin() + static_cast<std::ptrdiff_t>(before.node_count), mesh.file_number.end(),
                  next);
    }
    return before;
}

Mesh refine(Mesh mesh) {
    subdivide(mesh);
    return mesh;
}

}  // namespace skerry::mesh
