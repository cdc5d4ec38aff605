#include "engine/mesh/formats/raw_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skerry::mesh {

void NodeNumbers::add(std::int64_t number, const FileReader& reader) {
    if (!row_.try_emplace(number, static_cast<Index>(row_.size())).second)
        reader.complain("number", std::to_string(number) + ", the number of an earlier node",
                        "a different number for every node", "renumber the nodes");
}

Index NodeNumbers::row(std::int64_t number, const FileReader& reader) const {
    const auto place = row_.find(number);
    if (place == row_.end())
        reader.complain("node", std::to_string(number), "the number of a node that the file defines",
                        "correct the number or add the missing node");
    return place->second;
}

std::string elements_text(const RawMesh& mesh) {
    std::string text = std::to_string(mesh.triangles.size()) + " triangles";
    for (const auto& [kind, count] : mesh.others) text += ", " + std::to_string(count) + " " + kind;
    return text;
}

std::optional<int> as_label(Real number) {
    constexpr Real largest = std::numeric_limits<int>::max();
    if (!(std::abs(number) <= largest) || number != std::floor(number)) return {};
    return static_cast<int>(number);
}

void require_different(std::span<const Index> nodes, const FileReader& reader) {
    for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = a + 1; b < nodes.size(); ++b)
            if (nodes[a] == nodes[b])
                reader.complain("nodes", "the same node twice", "an element whose nodes all differ",
                                "remove this element or correct its nodes");
}

void take_tetrahedron(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh) {
    require_different(nodes, reader);
    if (nodes.size() == 10) {
        mesh.middle.resize(mesh.tetrahedra.size(), linear_tetrahedron);
        std::ranges::copy(nodes.subspan(4), mesh.middle.emplace_back().begin());
    }
    mesh.tetrahedra.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
}

void take_triangle(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh) {
    require_different(nodes, reader);
    if (nodes.size() == 6) {
        mesh.triangle_middle.resize(mesh.triangles.size(), linear_triangle);
        std::ranges::copy(nodes.subspan(3), mesh.triangle_middle.emplace_back().begin());
    }
    mesh.triangles.push_back({nodes[0], nodes[1], nodes[2]});
}

void add_polygon(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh) {
    if (nodes.size() < 3) reader.complain("node count", std::to_string(nodes.size()), "at least 3 nodes per polygon");
    for (std::size_t a = 1; a + 1 < nodes.size(); ++a) {
        take_triangle(std::array<Index, 3>{nodes[0], nodes[a], nodes[a + 1]}, reader, mesh);
    }
}

std::vector<std::size_t> add_surface_polygon(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh) {
    if (nodes.size() < 3) add_polygon(nodes, reader, mesh);
    std::vector<std::size_t> added;
    for (std::size_t a = 1; a + 1 < nodes.size(); ++a) {
        if (nodes[0] == nodes[a] || nodes[a] == nodes[a + 1] || nodes[a + 1] == nodes[0]) {
            ++mesh.flat_triangles;
            continue;
        }
        mesh.triangles.push_back({nodes[0], nodes[a], nodes[a + 1]});
        added.push_back(a);
    }
    return added;
}

}  // namespace skerry::mesh
