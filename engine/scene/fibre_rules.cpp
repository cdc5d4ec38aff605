// Keys of fibres in a scene file. Finds the body, the set of tetrahedra and the array of directions that they name.
#include <algorithm>

#include "engine/mesh/sets.h"
#include "engine/scene/scene_plan.h"
#include "engine/scene/scene_rules.h"

namespace skerry {

template <>
const Rule<FibreEntry>& rule_of<FibreEntry>() {
    using Entry = FibreEntry;
    static const auto rule =
        Rule<Entry>("fibres", "Fibres in a body, which resist stretch and contract with an active tension.")
            .key("name", &Entry::name, {.meaning = "name for sliders; default: fibres_NUMBER"})
            .key("body", &Entry::body, {.meaning = "name of the body", .required = true})
            .key("set", &Entry::set, {.meaning = "set of tetrahedra; default: all tetrahedra"})
            .key("direction", &Entry::direction, {.meaning = "direction of all fibres in the mesh"})
            .key("direction_array", &Entry::direction_array,
                 {.meaning = "name of an array of the mesh file with the direction in each tetrahedron: cell data of a "
                             "VTK file with three numbers"})
            .key("stiffness", &Entry::stiffness,
                 {.meaning = "modulus k_1 of the stretch; default: 0", .unit = "Pa", .limits = at_least(0)})
            .key("exponent", &Entry::exponent,
                 {.meaning = "exponent k_2 of the stretch; default: 0", .limits = at_least(0)})
            .key("tension", &Entry::tension,
                 {.meaning = "active tension, as force along the fibres per area at rest: a number, or pairs [time, "
                             "tension] between which it changes linearly; default: 0",
                  .unit = "Pa",
                  .limits = at_least(0)})
            .exactly_one({"direction", "direction_array"})
            .check([](const Place& place, const Entry& entry) {
                const auto pulls = [](const TimeKey& key) { return key.value != 0; };
                if (entry.stiffness == 0 && std::ranges::none_of(entry.tension.keys, pulls))
                    place.refuse("no \"stiffness\" and no \"tension\" above 0",
                                 "at least one of the two, because other fibres exert no force");
            });
    return rule;
}

FibrePlan plan_fibres(const FibreEntry& entry, const ScenePlan& plan) {
    FibrePlan fibres{.name = entry.name,
                     .body = find_body(plan, entry.body, entry.place.key("body")),
                     .settings = {},
                     .place = entry.place};
    const BodyPlan& body = plan.bodies[fibres.body];
    const Mesh& mesh = plan.meshes[body.mesh];
    FibreSettings& settings = fibres.settings;
    if (entry.set) {
        const Place place = entry.place.key("set");
        settings.tetrahedra = mesh::tetrahedra_of(find_set(*entry.set, mesh, body.sets, place), mesh.tetrahedra);
        if (settings.tetrahedra.empty())
            place.refuse(in_quotes(*entry.set) + ", which contains no tetrahedron", "a set with tetrahedra");
    }
    if (entry.direction) settings.direction = {*entry.direction};
    if (entry.direction_array) {
        const auto found = mesh.vectors.find(*entry.direction_array);
        if (found == mesh.vectors.end()) {
            std::vector<std::string> names;
            for (const auto& [name, vectors] : mesh.vectors) names.push_back(name);
            entry.place.key("direction_array")
                .refuse(
                    in_quotes(*entry.direction_array),
                    names.empty() ? "an array of vectors, but the mesh has none" : "an array of vectors of the mesh",
                    nearest_hint(*entry.direction_array, names));
        }
        settings.direction = found->second;
        if (!settings.tetrahedra.empty()) {
            settings.direction.clear();
            for (const Index t : settings.tetrahedra)
                settings.direction.push_back(found->second[static_cast<std::size_t>(t)]);
        }
    }
    settings.stiffness = entry.stiffness;
    settings.exponent = entry.exponent;
    settings.tension = entry.tension;
    return fibres;
}

}  // namespace skerry
