#include "engine/program/thin_part_text.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/mesh/thin/thin_parts.h"
#include "engine/output/number_text.h"

namespace skerry {

namespace {

// A thin part is reported if its mesh is at least this many times as stiff in bending as the exact elastic part. With
// smoothed elements in cubic cells the factor is 1.08 to 1.17 for two layers of cells, and 1.3 to 1.5 for one layer.
constexpr Real reported_stiffness = 1.25;
// Fraction by which the bending stiffness exceeds the exact one if the cells have the recommended size.
constexpr Real accepted_excess = 0.1;

/// Elements of a body: tetrahedra by material, and the constants of these materials.
struct ElementsOfThinBody {
    std::vector<MaterialZone> zones;
    std::vector<mesh::ElasticConstants> materials;

    void add(const MaterialSettings& material, ElementKind kind) {
        const auto row = static_cast<Index>(materials.size());
        materials.push_back({material.young_modulus, material.poisson_ratio});
        zones.push_back({row, resolved(kind, material.poisson_ratio), {}});
    }
};

/// Formats one coordinate of ThinPart::place. Values within rounding errors of 0 are printed as 0.
std::string coordinate(Real value, const mesh::ThinPart& part) {
    constexpr Real rounding = 1e-6;  // coordinates below this fraction of the length of the part are rounding errors
    return short_text(std::abs(value) < rounding * part.length ? 0 : value);
}

/// Least Poisson ratio at which elements of a kind are more than twice as stiff in bending as their material
/// (docs/methods/elasticity.md 7.3). Elements with the value 0.5 never lock, because Poisson ratios are below 0.5.
Real locks_from(ElementKind kind) {
    return kind == ElementKind::linear ? 0.45 : kind == ElementKind::edge_smoothed ? 0.49 : 0.5;
}

std::string locking_text(const ElementsOfThinBody& elements) {
    for (const MaterialZone& zone : elements.zones) {
        const Real poisson_ratio = elements.materials[static_cast<std::size_t>(zone.material)].poisson_ratio;
        if (!zone.tetrahedra.empty() && poisson_ratio >= locks_from(zone.kind))
            return "elements of the kind \"" + std::string(name_of(zone.kind)) + "\" lock at a Poisson ratio of " +
                   short_text(poisson_ratio) +
                   ": in bending they are more than twice as stiff as the material: set \"element\" of the body to "
                   "\"smoothed\"";
    }
    return {};
}

ElementsOfThinBody elements_of_body(const Mesh& mesh, const BodyCase& body_case) {
    ElementsOfThinBody elements;
    elements.add(body_case.material, body_case.body.element);
    std::map<int, std::size_t> zone_of;
    for (const auto& [label, material] : body_case.labelled) {
        zone_of.emplace(label, elements.zones.size());
        elements.add(material, body_case.body.element);
    }
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto zone = mesh.label.empty() ? zone_of.end() : zone_of.find(mesh.label[t]);
        elements.zones[zone == zone_of.end() ? 0 : zone->second].tetrahedra.push_back(static_cast<Index>(t));
    }
    return elements;
}

}  // namespace

std::string thin_part_text(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary,
                           const BodyCase& body_case) {
    const ElementsOfThinBody elements = elements_of_body(mesh, body_case);
    std::vector<mesh::ThinPart> parts = mesh::thin_parts(mesh, boundary, elements.zones, elements.materials);
    std::erase_if(parts, [](const mesh::ThinPart& part) { return part.stiffness < reported_stiffness; });
    if (parts.empty()) return locking_text(elements);
    const mesh::ThinPart& part = parts.front();
    const Real layers = std::max(Real{1}, std::round(part.layers));
    // The excess of stiffness is proportional to the square of the size of the cells.
    const Real finer = std::sqrt((part.stiffness - 1) / accepted_excess);
    return "a part " + with_unit(part.thickness, "m") + " thick and " + with_unit(part.length, "m") + " long around (" +
           coordinate(part.place.x(), part) + ", " + coordinate(part.place.y(), part) + ", " +
           coordinate(part.place.z(), part) + ") m has " + short_text(layers) + (layers > 1 ? " layers" : " layer") +
           " of cells and is about " + short_text(part.stiffness, 2) + " times as stiff in bending as its material" +
           (parts.size() == 2  ? ", and 1 more part is too stiff"
            : parts.size() > 2 ? ", and " + grouped(parts.size() - 1) + " more parts are too stiff"
                               : "") +
           ": to reduce the excess to about " + percent(accepted_excess) + ", make the cells there " +
           short_text(finer, 2) + " times smaller in all directions" +
           (body_case.body.element == ElementKind::linear ? ", or first set \"element\" of the body to \"smoothed\""
                                                          : "");
}

}  // namespace skerry
