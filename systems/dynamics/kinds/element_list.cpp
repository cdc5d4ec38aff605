#include "systems/dynamics/kinds/element_list.h"

#include "components/check.h"

namespace skerry {

ElementKind resolved(ElementKind kind, Real poisson_ratio, bool multirate) {
    constexpr Real largest_edge_smoothed_ratio = 0.25;
    if (kind != ElementKind::smoothed) return kind;
    if (multirate) return ElementKind::linear;
    return poisson_ratio > largest_edge_smoothed_ratio ? ElementKind::edge_node_smoothed : ElementKind::edge_smoothed;
}

ElementList elements_of(const RestMesh& mesh, ElementKind kind) {
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
    return list;
}

}  // namespace skerry
