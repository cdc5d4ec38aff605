#include "engine/fill/explicit_body.h"

#include <algorithm>
#include <utility>

namespace skerry {

ExplicitBody explicit_body(const Mesh& mesh, const BodyCase& body_case) {
    Settings settings = body_case.settings;
    settings.step_size.reset();
    settings.clusters = false;
    settings.backend = Backend::serial;
    World world(settings);
    BodySettings body = body_case.body;
    body.dynamics = BodyDynamics::explicit_elastic;
    body.material = world.add_material(body_case.material);
    body.materials.clear();
    for (const auto& [label, material] : body_case.labelled)
        if (std::ranges::find(mesh.label, label) != mesh.label.end())
            body.materials.emplace(label, world.add_material(material));
    const BodyHandle handle = world.add_body(mesh, body);
    return {std::move(world), handle};
}

}  // namespace skerry
