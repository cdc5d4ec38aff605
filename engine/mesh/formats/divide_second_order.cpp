#include <algorithm>
#include <utility>

#include "engine/mesh/formats/raw_mesh.h"

// Second-order elements are divided rather than reduced to their corners, because the mesh is then much more accurate.
// Example: a cantilever of 198 tetrahedra, with edges as long as its thickness. Its tip sinks 1.0 % less than in beam
// theory, but 12.8 % less if the mesh keeps the corners only.
namespace skerry::mesh {
namespace {

/// Indices of the nodes in the middle of edges. The key holds the lower corner of the edge in its upper 32 bits and the
/// other corner in its lower 32 bits.
using MiddleNodes = std::unordered_map<std::uint64_t, Index>;

std::uint64_t edge_key(Index a, Index b) {
    const auto [lower, upper] = std::minmax(a, b);
    return static_cast<std::uint64_t>(lower) << 32 | static_cast<std::uint64_t>(upper);
}

/// Adds the eight parts of a second-order tetrahedron: one at each corner, and four around the shortest diagonal of the
/// octahedron between the nodes in the middle of the edges (S. Zhang, "Successive subdivisions of tetrahedra and
/// multigrid methods on tetrahedral meshes", 1995).
void add_parts(const std::vector<Vec3>& nodes, const std::array<Index, 4>& corner, const std::array<Index, 6>& middle,
               std::vector<std::array<Index, 4>>& parts) {
    const auto& [m01, m12, m20, m03, m13, m23] = middle;
    const std::array<Index, 4> at_corners[] = {
        {corner[0], m01, m20, m03}, {corner[1], m12, m01, m13}, {corner[2], m20, m12, m23}, {corner[3], m03, m23, m13}};
    parts.insert(parts.end(), std::begin(at_corners), std::end(at_corners));
    struct Diagonal {
        Index first, last;
        // The other four nodes, as a ring around the diagonal. Both ends of the diagonal and two successive nodes of
        // the ring form a tetrahedron of positive volume.
        std::array<Index, 4> around;
    };
    const std::array<Diagonal, 3> diagonals{
        {{m01, m23, {m12, m20, m03, m13}}, {m12, m03, {m01, m13, m23, m20}}, {m20, m13, {m01, m12, m23, m03}}}};
    const Diagonal& shortest = *std::ranges::min_element(diagonals, {}, [&](const Diagonal& d) {
        return (nodes[static_cast<std::size_t>(d.first)] - nodes[static_cast<std::size_t>(d.last)]).squaredNorm();
    });
    for (std::size_t i = 0; i < 4; ++i)
        parts.push_back({shortest.first, shortest.last, shortest.around[i], shortest.around[(i + 1) % 4]});
}

void add_parts(const std::array<Index, 3>& corner, const std::array<Index, 3>& middle,
               std::vector<std::array<Index, 3>>& parts) {
    const auto& [m01, m12, m20] = middle;
    const std::array<Index, 3> all[] = {
        {corner[0], m01, m20}, {corner[1], m12, m01}, {corner[2], m20, m12}, {m01, m12, m20}};
    parts.insert(parts.end(), std::begin(all), std::end(all));
}

/// Divides each face of the sets into four if all three of its edges have a node in the middle. Other faces stay whole.
void divide_faces(const RawMesh& mesh, std::map<std::string, MeshSet>& sets) {
    if (std::ranges::all_of(sets, [](const auto& item) { return item.second.faces.empty(); })) return;
    MiddleNodes middle_of;
    const auto add = [&](const auto& elements, const auto& middle) {
        for (std::size_t t = 0; t < middle.size(); ++t)
            for (std::size_t e = 0; e < middle[t].size() && middle[t][0] != no_index; ++e)
                middle_of[edge_key(elements[t][second_order_edges[e][0]], elements[t][second_order_edges[e][1]])] =
                    middle[t][e];
    };
    add(mesh.triangles, mesh.triangle_middle);
    add(mesh.tetrahedra, mesh.middle);
    for (auto& [name, set] : sets) {
        std::vector<std::array<Index, 3>> parts;
        for (const std::array<Index, 3>& face : set.faces) {
            std::array<Index, 3> middle{no_index, no_index, no_index};
            for (std::size_t e = 0; e < 3; ++e)
                if (const auto found = middle_of.find(edge_key(face[e], face[(e + 1) % 3])); found != middle_of.end())
                    middle[e] = found->second;
            if (std::ranges::count(middle, no_index) == 0)
                add_parts(face, middle, parts);
            else
                parts.push_back(face);
        }
        set.faces = std::move(parts);
    }
}

void divide_tetrahedra(RawMesh& mesh) {
    std::vector<std::array<Index, 4>> parts;
    std::vector<Index> first;  // index in `parts` of each tetrahedron's first part; last entry: the number of parts
    mesh.middle.resize(mesh.tetrahedra.size(), linear_tetrahedron);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        first.push_back(static_cast<Index>(parts.size()));
        if (mesh.middle[t] == linear_tetrahedron)
            parts.push_back(mesh.tetrahedra[t]);
        else
            add_parts(mesh.nodes, mesh.tetrahedra[t], mesh.middle[t], parts);
    }
    first.push_back(static_cast<Index>(parts.size()));
    const auto count_of = [&](std::size_t t) { return static_cast<std::size_t>(first[t + 1] - first[t]); };
    const auto repeat = [&](auto& column) {
        std::remove_reference_t<decltype(column)> repeated;
        for (std::size_t t = 0; t < column.size(); ++t) repeated.insert(repeated.end(), count_of(t), column[t]);
        column = std::move(repeated);
    };
    repeat(mesh.label);
    for (auto& [name, vectors] : mesh.vectors) repeat(vectors);
    for (auto& [name, set] : mesh.sets) {
        std::vector<Index> members;
        for (const Index t : set.tetrahedra)
            for (Index part = first[static_cast<std::size_t>(t)]; part < first[static_cast<std::size_t>(t) + 1]; ++part)
                members.push_back(part);
        set.tetrahedra = std::move(members);
    }
    mesh.tetrahedra = std::move(parts);
    mesh.middle.clear();
}

void divide_triangles(RawMesh& mesh) {
    std::vector<std::array<Index, 3>> parts;
    mesh.triangle_middle.resize(mesh.triangles.size(), linear_triangle);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (mesh.triangle_middle[t] == linear_triangle)
            parts.push_back(mesh.triangles[t]);
        else
            add_parts(mesh.triangles[t], mesh.triangle_middle[t], parts);
    }
    mesh.triangles = std::move(parts);
    mesh.triangle_middle.clear();
}

/// Returns the node in the middle of an edge. The first call for an edge adds this node to the mesh.
Index middle_node(Index a, Index b, RawMesh& mesh, MiddleNodes& middle_nodes) {
    const auto [place, added] = middle_nodes.try_emplace(edge_key(a, b), static_cast<Index>(mesh.nodes.size()));
    if (added)
        mesh.nodes.emplace_back((mesh.nodes[static_cast<std::size_t>(a)] + mesh.nodes[static_cast<std::size_t>(b)]) /
                                2);
    return place->second;
}

}  // namespace

void add_middle_nodes(RawMesh& mesh) {
    MiddleNodes middle_nodes;
    middle_nodes.reserve(2 * (mesh.tetrahedra.size() + mesh.triangles.size()));
    const auto add = [&](const auto& elements, auto& middle) {
        middle.resize(elements.size());
        for (std::size_t i = 0; i < elements.size(); ++i)
            for (std::size_t e = 0; e < middle[i].size(); ++e)
                middle[i][e] = middle_node(elements[i][second_order_edges[e][0]], elements[i][second_order_edges[e][1]],
                                           mesh, middle_nodes);
    };
    add(mesh.tetrahedra, mesh.middle);
    add(mesh.triangles, mesh.triangle_middle);
}

void divide_second_order(RawMesh& mesh) {
    const std::size_t tetrahedra =
        mesh.middle.size() - static_cast<std::size_t>(std::ranges::count(mesh.middle, linear_tetrahedron));
    const std::size_t triangles = mesh.triangle_middle.size() -
                                  static_cast<std::size_t>(std::ranges::count(mesh.triangle_middle, linear_triangle));
    divide_faces(mesh, mesh.sets);
    if (tetrahedra > 0) divide_tetrahedra(mesh);
    if (triangles > 0) divide_triangles(mesh);
    if (tetrahedra > 0)
        mesh.notes.push_back(std::to_string(tetrahedra) +
                             " tetrahedra of second order were divided into eight linear ones each");
    else if (triangles > 0 && mesh.tetrahedra.empty())
        mesh.notes.push_back(std::to_string(triangles) +
                             " triangles of second order were divided into four linear ones each");
}

}  // namespace skerry::mesh
