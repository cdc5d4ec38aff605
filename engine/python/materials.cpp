// Materials with values from the literature.
#include "skerry/materials.h"

#include "engine/python/bind.h"
#include "engine/python/read_settings.h"

namespace skerry::python {

namespace {

nb::str text_of(std::string_view text) {
    return nb::str(text.data(), text.size());
}

/// Names of all materials.
nb::list names() {
    nb::list names;
    for (const NamedMaterial& material : named_materials()) names.append(text_of(material.name));
    return names;
}

/// Sources of the values of a material, by the names of the settings.
nb::dict sources(const std::string& name) {
    nb::dict sources;
    for (const NamedMaterial& material : named_materials()) {
        if (material.name != name) continue;
        sources["young_modulus"] = text_of(material.young_modulus.source);
        sources["poisson_ratio"] = text_of(material.poisson_ratio.source);
        sources["density"] = text_of(material.density.source);
        if (material.loss_factor) sources["loss_factor"] = text_of(material.loss_factor->source);
    }
    for (const KnownFriction& pair : known_frictions())
        if (pair.first == name && pair.second == name) sources["friction"] = text_of(pair.source);
    return sources;
}

}  // namespace

void bind_materials(nb::module_& module) {
    module.def("material_names", names);
    module.def("named_material", [](const std::string& name) { return values_of(named_material(name)); });
    module.def("material_sources", sources);
}

}  // namespace skerry::python
