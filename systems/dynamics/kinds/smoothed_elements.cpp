// Elements that average the deformation gradient F over several tetrahedra (docs/methods/elasticity.md 7). Each
// tetrahedron e contributes a fraction w of its volume V_e to the element. The gradient of its shape function of node k
// is g_ek. The element has
//     the volume                                      W   = sum_e w V_e
//     the gradient of the shape function of node k    g_k = sum_e (w V_e / W) g_ek
#include <algorithm>
#include <array>

#include "components/counting_sort.h"
#include "components/ragged.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

namespace {

/// Collects the groups of tetrahedra that the elements cover, one group for each edge (or node) of the mesh. An item is
/// one edge (or node) of one tetrahedron: item i belongs to tetrahedron i / items_of_tetrahedron, and `first_alike[i]`
/// is the first item at the same edge (or node).
///
/// Groups are ordered by their first items, so that neighbouring elements stay close in memory. Tetrahedra of a group
/// ascend.
Ragged<Index> groups_of(std::span<const Index> first_alike, Index items_of_tetrahedron) {
    std::vector<Index> group(first_alike.size());
    Ragged<Index> groups;
    groups.offset.push_back(0);
    for (std::size_t i = 0; i < group.size(); ++i) {
        const auto first = static_cast<std::size_t>(first_alike[i]);
        group[i] = first == i ? static_cast<Index>(groups.size()) : group[first];
        if (first == i) groups.offset.push_back(0);
        ++groups.offset[static_cast<std::size_t>(group[i]) + 1];
    }
    for (std::size_t g = 0; g < groups.size(); ++g) groups.offset[g + 1] += groups.offset[g];
    groups.item.resize(group.size());
    std::vector<Index> next(groups.offset.begin(), groups.offset.end());
    for (std::size_t i = 0; i < group.size(); ++i)
        groups.item[static_cast<std::size_t>(next[static_cast<std::size_t>(group[i])]++)] =
            static_cast<Index>(i) / items_of_tetrahedron;
    return groups;
}

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

    /// Removes the nodes at which the element has no gradient, such as an inner node in its own element. Rounding
    /// errors leave about 1e-16 of a gradient g there. In g g^T / |g|^2, a part of the bound on the step
    /// (stiffness_share.cpp), this remainder would count as much as a full gradient.
    void drop_zero_gradients() {
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

void add_groups(const RestMesh& mesh, const Ragged<Index>& groups, Real share, ElementPart part, ElementList& list) {
    std::vector<TetrahedronGradients> rest;
    rest.reserve(mesh.tetrahedra.size());
    for (const auto& tetrahedron : mesh.tetrahedra) rest.push_back(tetrahedron_gradients(tetrahedron, mesh.position));
    // In a manifold mesh, n tetrahedra around an edge or a node have at most n + 3 nodes.
    const std::size_t most_nodes = list.node.size() + groups.item.size() + 3 * groups.size();
    list.node.reserve(most_nodes);
    list.gradient.reserve(most_nodes);
    list.first_node.reserve(list.first_node.size() + groups.size());
    list.first_tetrahedron.reserve(list.first_tetrahedron.size() + groups.size());
    list.volume.reserve(list.volume.size() + groups.size());
    list.part.reserve(list.part.size() + groups.size());
    list.tetrahedron.reserve(list.tetrahedron.size() + groups.item.size());
    Gradients element;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const std::span<const Index> group = groups[g];
        Real volume = 0;
        for (const Index t : group) volume += share * rest[static_cast<std::size_t>(t)].volume;
        element.node.clear();
        element.gradient.clear();
        for (const Index t : group) {
            const TetrahedronGradients& tetrahedron = rest[static_cast<std::size_t>(t)];
            for (std::size_t a = 0; a < 4; ++a)
                element.add(mesh.tetrahedra[static_cast<std::size_t>(t)][a],
                            (share * tetrahedron.volume / volume) * tetrahedron.g[a]);
        }
        element.drop_zero_gradients();
        // The force on node 0 is minus the sum of the other forces (for_each_force). Its gradient is therefore set to
        // minus the sum of the other gradients, which differs from the sum of its tetrahedron gradients by rounding
        // errors and dropped nodes.
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
    constexpr std::array<std::array<std::size_t, 2>, 6> corners{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
    struct Side {
        Index low, high, item;
    };
    std::vector<Side> sides, buffer;
    sides.reserve(corners.size() * mesh.tetrahedra.size());
    for (const std::array<Index, 4>& node : mesh.tetrahedra)
        for (const auto& [a, b] : corners)
            sides.push_back({std::min(node[a], node[b]), std::max(node[a], node[b]), static_cast<Index>(sides.size())});
    const auto node_count = static_cast<Index>(mesh.position.size());
    counting_sort(sides, buffer, node_count, [](const Side& side) { return side.low; });
    // The sort has placed edges with the same lower node next to each other. `seen[n]` is the first of these edges with
    // the upper node n; an entry with another lower node is out of date.
    std::vector<Index> first_alike(sides.size());
    std::vector<Side> seen(mesh.position.size(), {no_index, no_index, no_index});
    for (const Side& side : sides) {
        Side& first = seen[static_cast<std::size_t>(side.high)];
        if (first.low != side.low) first = side;
        first_alike[static_cast<std::size_t>(side.item)] = first.item;
    }
    add_groups(mesh, groups_of(first_alike, corners.size()), Real{1} / 6, part, list);
}

void add_node_elements(const RestMesh& mesh, ElementPart part, ElementList& list) {
    std::vector<Index> first_alike, first_at(mesh.position.size(), no_index);
    first_alike.reserve(4 * mesh.tetrahedra.size());
    for (const std::array<Index, 4>& tetrahedron : mesh.tetrahedra)
        for (const Index node : tetrahedron) {
            Index& first = first_at[static_cast<std::size_t>(node)];
            if (first == no_index) first = static_cast<Index>(first_alike.size());
            first_alike.push_back(first);
        }
    add_groups(mesh, groups_of(first_alike, 4), Real{1} / 4, part, list);
}

}  // namespace skerry
