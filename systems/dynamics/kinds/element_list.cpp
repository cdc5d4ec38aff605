#include "systems/dynamics/kinds/element_list.h"

#include <algorithm>

#include "components/check.h"

namespace skerry {

namespace {

/// Appends the elements of `from` to `to`. `tetrahedra[t]`: number in `to` of the tetrahedron t of `from`.
void append(const ElementList& from, std::span<const Index> tetrahedra, ElementList& to) {
    const auto append_all = [](const auto& more, auto& column) {
        column.insert(column.end(), more.begin(), more.end());
    };
    for (std::size_t e = 0; e < from.size(); ++e) {
        to.first_node.push_back(to.node.size() + from.first_node[e + 1]);
        to.first_tetrahedron.push_back(to.tetrahedron.size() + from.first_tetrahedron[e + 1]);
    }
    append_all(from.node, to.node);
    append_all(from.gradient, to.gradient);
    append_all(from.volume, to.volume);
    append_all(from.part, to.part);
    append_all(from.material, to.material);
    for (const Index t : from.tetrahedron) to.tetrahedron.push_back(tetrahedra[static_cast<std::size_t>(t)]);
}

}  // namespace

ElementKind resolved(ElementKind kind, Real poisson_ratio) {
    constexpr Real largest_edge_smoothed_ratio = 0.25;
    if (kind != ElementKind::smoothed) return kind;
    return poisson_ratio > largest_edge_smoothed_ratio ? ElementKind::edge_node_smoothed : ElementKind::edge_smoothed;
}

ElementList elements_of(const RestMesh& mesh, ElementKind kind, Index material) {
    SKERRY_CHECK(kind != ElementKind::smoothed);
    ElementList list;
    switch (kind) {
        case ElementKind::linear:
            add_tetrahedron_elements(mesh, list);
            break;
        case ElementKind::edge_node_smoothed:
            add_edge_elements(mesh, ElementPart::shear, list);
            add_node_elements(mesh, ElementPart::volume, list);
            break;
        case ElementKind::edge_smoothed:
        case ElementKind::smoothed:
            add_edge_elements(mesh, ElementPart::whole, list);
            break;
    }
    list.material.assign(list.size(), material);
    return list;
}

ElementList elements_of(const RestMesh& mesh, std::span<const MaterialZone> zones) {
    if (zones.size() == 1 && zones.front().tetrahedra.size() == mesh.tetrahedra.size())
        return elements_of(mesh, zones.front().kind, zones.front().material);
    ElementList list;
    std::vector<std::array<Index, 4>> tetrahedra;
    for (const MaterialZone& zone : zones) {
        tetrahedra.clear();
        for (const Index t : zone.tetrahedra) tetrahedra.push_back(mesh.tetrahedra[static_cast<std::size_t>(t)]);
        append(elements_of({tetrahedra, mesh.position}, zone.kind, zone.material), zone.tetrahedra, list);
    }
    return list;
}

void add_guards(const RestMesh& mesh, std::span<const MaterialZone> zones, ElementList& list) {
    if (std::ranges::all_of(zones, [](const MaterialZone& zone) { return zone.kind == ElementKind::linear; })) return;
    Real whole = 0;  // six times the volume of the mesh, for comparison with six_volumes() [m^3]
    for (const auto& tetrahedron : mesh.tetrahedra) whole += six_volumes(tetrahedron, mesh.position);
    const Real bound = guarded_volume * whole / static_cast<Real>(mesh.tetrahedra.size());
    const std::vector<std::uint8_t> sliver = sliver_tetrahedra(mesh);
    std::vector<std::array<Index, 4>> small;
    for (const MaterialZone& zone : zones) {
        if (zone.kind == ElementKind::linear) continue;
        small.clear();
        for (const Index t : zone.tetrahedra) {
            const auto& tetrahedron = mesh.tetrahedra[static_cast<std::size_t>(t)];
            if (six_volumes(tetrahedron, mesh.position) < bound && sliver[static_cast<std::size_t>(t)] == 0)
                small.push_back(tetrahedron);
        }
        if (small.empty()) continue;
        ElementList guards = elements_of({small, mesh.position}, ElementKind::linear, zone.material);
        std::ranges::fill(guards.part, ElementPart::guard);
        std::ranges::fill(guards.volume, Real(0));
        std::ranges::fill(guards.first_tetrahedron, std::size_t{0});
        guards.tetrahedron.clear();
        append(guards, {}, list);
    }
}

}  // namespace skerry
