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

}  // namespace skerry::mesh
