// Elements over several tetrahedra: W = sum_e w V_e, g_k = sum_e (w V_e / W) g_ek (docs/methods/elasticity.md 7).
#include <algorithm>
#include <unordered_map>

#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

namespace {

/// The tetrahedra of one element, and the node that the others are compared with: one that all of them have.
struct Group {
    Index anchor;
    std::vector<Index> tetrahedra;
};

void add_groups(const RestMesh& mesh, std::span<const Group> groups, Real share, ElementPart part, ElementList& list) {
    std::vector<TetrahedronGradients> rest;
    rest.reserve(mesh.tetrahedra.size());
    for (const auto& tetrahedron : mesh.tetrahedra)
        rest.push_back(tetrahedron_gradients(tetrahedron, mesh.position, mesh.rotation));
    for (const Group& group : groups) {
        Real volume = 0;
        for (const Index t : group.tetrahedra) volume += share * rest[static_cast<std::size_t>(t)].volume;
        const std::size_t first = list.node.size();
        list.node.push_back(group.anchor);
        list.gradient.push_back(Vec3::Zero());
        for (const Index t : group.tetrahedra) {
            const TetrahedronGradients& of = rest[static_cast<std::size_t>(t)];
            for (std::size_t a = 0; a < 4; ++a) {
                const Index node = mesh.tetrahedra[static_cast<std::size_t>(t)][a];
                const auto known =
                    std::find(list.node.begin() + static_cast<std::ptrdiff_t>(first), list.node.end(), node);
                const auto place = static_cast<std::size_t>(known - list.node.begin());
                if (known == list.node.end()) {
                    list.node.push_back(node);
                    list.gradient.push_back(Vec3::Zero());
                }
                list.gradient[place] += (share * of.volume / volume) * of.g[a];
            }
        }
        // to the last bit, as the kernel has it
        Vec3 others = Vec3::Zero();
        for (std::size_t k = first + 1; k < list.gradient.size(); ++k) others += list.gradient[k];
        list.gradient[first] = -others;
        list.first_node.push_back(list.node.size());
        list.tetrahedron.insert(list.tetrahedron.end(), group.tetrahedra.begin(), group.tetrahedra.end());
        list.first_tetrahedron.push_back(list.tetrahedron.size());
        list.volume.push_back(volume);
        list.part.push_back(part);
    }
}

}  // namespace

void add_edge_elements(const RestMesh& mesh, ElementPart part, ElementList& list) {
    // in the order in which the mesh comes to them: neighbours stay neighbours
    std::vector<Group> groups;
    std::unordered_map<std::uint64_t, std::size_t> group_of;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto& node = mesh.tetrahedra[t];
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = a + 1; b < 4; ++b) {
                const auto [low, high] = std::minmax(node[a], node[b]);
                const std::uint64_t key = static_cast<std::uint64_t>(low) << 32 |
                                          static_cast<std::uint64_t>(static_cast<std::uint32_t>(high));
                const auto [known, fresh] = group_of.try_emplace(key, groups.size());
                if (fresh) groups.push_back({low, {}});
                groups[known->second].tetrahedra.push_back(static_cast<Index>(t));
            }
    }
    add_groups(mesh, groups, Real{1} / 6, part, list);
}

void add_node_elements(const RestMesh& mesh, ElementPart part, ElementList& list) {
    std::vector<Group> groups;
    std::vector<std::size_t> group_of(mesh.position.size(), static_cast<std::size_t>(-1));
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const Index node : mesh.tetrahedra[t]) {
            std::size_t& group = group_of[static_cast<std::size_t>(node)];
            if (group == static_cast<std::size_t>(-1)) {
                group = groups.size();
                groups.push_back({node, {}});
            }
            groups[group].tetrahedra.push_back(static_cast<Index>(t));
        }
    add_groups(mesh, groups, Real{1} / 4, part, list);
}

}  // namespace skerry
