// Elements that average F over several tetrahedra. Each tetrahedron e contributes a fraction w of its volume V_e to the
// element. The element then has the volume W = sum_e w V_e, and its node k has the gradient g_k = sum_e (w V_e / W)
// g_ek, with the gradient g_ek of tetrahedron e at node k (docs/methods/elasticity.md 7).
#include <algorithm>
#include <unordered_map>

#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

namespace {

using Group = std::vector<Index>;  // tetrahedra that one element covers

/// Nodes and gradients of an element under construction.
struct Gradients {
    std::vector<Index> node;
    std::vector<Vec3> gradient;

    void add(Index n, const Vec3& g) {
        const auto known = std::find(node.begin(), node.end(), n);
        if (known != node.end()) {
            gradient[static_cast<std::size_t>(known - node.begin())] += g;
        } else {
            node.push_back(n);
            gradient.push_back(g);
        }
    }

    /// Removes the nodes whose gradients cancel, such as an inner node in its own element. Rounding errors leave about
    /// 1e-16 of a gradient. This remainder moves nothing, but would count in the bound on the step, however small it
    /// is.
    void drop_nothings() {
        constexpr Real nothing = 1e-12;
        Real largest = 0;
        for (const Vec3& g : gradient) largest = std::max(largest, g.squaredNorm());
        std::size_t kept = 0;
        for (std::size_t k = 0; k < node.size(); ++k) {
            if (gradient[k].squaredNorm() <= nothing * nothing * largest) continue;
            node[kept] = node[k];
            gradient[kept++] = gradient[k];
        }
        node.resize(kept);
        gradient.resize(kept);
    }
};

void add_groups(const RestMesh& mesh, std::span<const Group> groups, Real share, ElementPart part, ElementList& list) {
    std::vector<TetrahedronGradients> rest;
    rest.reserve(mesh.tetrahedra.size());
    for (const auto& tetrahedron : mesh.tetrahedra) rest.push_back(tetrahedron_gradients(tetrahedron, mesh.position));
    Gradients element;
    for (const Group& group : groups) {
        Real volume = 0;
        for (const Index t : group) volume += share * rest[static_cast<std::size_t>(t)].volume;
        element.node.clear();
        element.gradient.clear();
        for (const Index t : group) {
            const TetrahedronGradients& of = rest[static_cast<std::size_t>(t)];
            for (std::size_t a = 0; a < 4; ++a)
                element.add(mesh.tetrahedra[static_cast<std::size_t>(t)][a], (share * of.volume / volume) * of.g[a]);
        }
        element.drop_nothings();
        // The gradient of node 0 is computed with the same operations as in the kernel, so that it is bitwise equal.
        Vec3 others = Vec3::Zero();
        for (std::size_t k = 1; k < element.gradient.size(); ++k) others += element.gradient[k];
        element.gradient.front() = -others;
        list.node.insert(list.node.end(), element.node.begin(), element.node.end());
        list.gradient.insert(list.gradient.end(), element.gradient.begin(), element.gradient.end());
        list.first_node.push_back(list.node.size());
        list.tetrahedron.insert(list.tetrahedron.end(), group.begin(), group.end());
        list.first_tetrahedron.push_back(list.tetrahedron.size());
        list.volume.push_back(volume);
        list.part.push_back(part);
    }
}

}  // namespace

void add_edge_elements(const RestMesh& mesh, ElementPart part, ElementList& list) {
    // Edges are ordered by their first tetrahedra, so that neighbouring edges stay close in memory.
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
                if (fresh) groups.emplace_back();
                groups[known->second].push_back(static_cast<Index>(t));
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
                groups.emplace_back();
            }
            groups[group].push_back(static_cast<Index>(t));
        }
    add_groups(mesh, groups, Real{1} / 4, part, list);
}

}  // namespace skerry
