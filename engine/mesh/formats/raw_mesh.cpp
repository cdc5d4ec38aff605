#include "engine/mesh/formats/raw_mesh.h"

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

void add_polygon(std::span<const Index> nodes, const FileReader& reader, RawMesh& mesh) {
    if (nodes.size() < 3) reader.complain("node count", std::to_string(nodes.size()), "at least 3 nodes per polygon");
    for (std::size_t a = 1; a + 1 < nodes.size(); ++a) {
        const std::array<Index, 3> triangle{nodes[0], nodes[a], nodes[a + 1]};
        require_different(triangle, reader);
        mesh.triangles.push_back(triangle);
    }
}

}  // namespace skerry::mesh
