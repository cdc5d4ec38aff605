// Materials with values from the literature.
#include "skerry/materials.h"

#include "engine/python/bind.h"
#include "engine/python/read_settings.h"

namespace skerry::python {

namespace {

nb::str text_of(std::string_view text) {
    return nb::str(text.data(), text.size());
}

MaterialSettings settings_of(nb::handle material) {
    MaterialSettings settings;
    read(material, settings);
    return settings;
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

/// Values of all pairs of known_frictions(), by the fields of the class KnownFriction.
nb::list frictions() {
    nb::list pairs;
    for (const KnownFriction& pair : known_frictions()) {
        nb::dict values;
        values["first"] = text_of(pair.first);
        values["second"] = text_of(pair.second);
        values["static_friction"] = pair.static_friction;
        values["dynamic_friction"] = pair.dynamic_friction;
        values["source"] = text_of(pair.source);
        pairs.append(values);
    }
    return pairs;
}

}  // namespace

void bind_materials(nb::module_& module) {
    module.def("material_names", names);
    module.def("named_material", [](const std::string& name) { return values_of(named_material(name)); });
    module.def("material_sources", sources);
    module.def("known_frictions", frictions);
    module.def("ogden", [](const std::vector<std::array<Real, 2>>& pairs, Real bulk_modulus, nb::handle base) {
        std::vector<OgdenTerm> terms;
        for (const auto& [modulus, exponent] : pairs) terms.push_back({modulus, exponent});
        return values_of(ogden(terms, bulk_modulus, settings_of(base)));
    });
    module.def("orthotropic", [](nb::handle moduli, nb::handle base) {
        OrthotropicModuli settings;
        read(moduli, settings);
        return values_of(orthotropic(settings, settings_of(base)));
    });
    module.def("mooney_rivlin", [](Real c10, Real c01, Real bulk_modulus, nb::handle base) {
        return values_of(mooney_rivlin(c10, c01, bulk_modulus, settings_of(base)));
    });
}

}  // namespace skerry::python
