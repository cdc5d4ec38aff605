#include "engine/scene/scene_plan.h"
#include "skerry/scene.h"

namespace skerry {

Scene build_scene(const ScenePlan& plan) {
    const Place top(plan.file);
    Scene scene{.name = plan.name,
                .description = plan.description,
                .seconds = plan.seconds,
                .frame_step = plan.frame_step,
                .world = called_at(top.key("settings"), [&] { return World(plan.settings); }),
                .probes = {},
                .probe_step = plan.probe_step};
    World& world = scene.world;

    std::vector<MaterialHandle> materials;
    for (const auto& [name, material] : plan.materials)
        materials.push_back(called_at(top.key("materials").key(name),
                                      [&, &settings = material] { return world.add_material(settings); }));
    std::vector<BodyHandle> bodies;
    for (const BodyPlan& body : plan.bodies) {
        BodySettings settings = body.settings;
        settings.material = materials[body.material];
        for (const auto& [label, row] : body.materials) settings.materials.emplace(label, materials[row]);
        bodies.push_back(called_at(body.place, [&] { return world.add_body(plan.meshes[body.mesh], settings); }));
        for (const PinPlan& pin : body.pins)
            called_at(pin.place, [&] { return world.attach(bodies.back(), pin.nodes, pin.motion, pin.pivot); });
    }
    for (const ColliderPlan& collider : plan.colliders)
        called_at(collider.place, [&] { return world.add_collider(collider.shape, collider.settings); });
    called_at(top, [&] { world.settle_start(); });
    for (const ProbePlan& probe : plan.probes) scene.probes.push_back({probe.name, bodies[probe.body], probe.nodes});
    return scene;
}

Scene load_scene(const std::filesystem::path& file, const SceneOverrides& overrides) {
    return build_scene(plan_scene(file, overrides));
}

}  // namespace skerry
