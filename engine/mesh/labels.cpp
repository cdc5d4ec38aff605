#include "engine/mesh/labels.h"

namespace skerry::mesh {

std::map<int, std::size_t> count_labels(const Mesh& mesh) {
    std::map<int, std::size_t> count;
    for (const int label : mesh.label) ++count[label];
    return count;
}

std::string expected_label(const Mesh& mesh) {
    if (mesh.label.empty()) return "no label, because the mesh has no labels";
    constexpr std::size_t most = 20;
    std::string text = "one of the labels of the mesh: ";
    std::size_t listed = 0;
    for (const auto& [label, tetrahedra] : count_labels(mesh)) {
        if (listed == most) return text + ", ...";
        text += (listed++ > 0 ? ", " : "") + std::to_string(label);
    }
    return text;
}

}  // namespace skerry::mesh
