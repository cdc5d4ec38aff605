#include <algorithm>

#include "engine/mesh/require_positive.h"
#include "engine/mesh/surface/check_shells.h"
#include "engine/scene/scene_plan.h"
#include "engine/world/tuning.h"
#include "engine/world/visuals.h"
#include "skerry/scene.h"
#include "skerry/surface.h"

namespace skerry {

namespace {

struct Built {
    const World& world;
    const std::vector<BodyHandle>& bodies;
    const std::vector<ColliderHandle>& colliders;
    const std::vector<std::vector<AttachmentHandle>>& pins;  // pins of each body, indexed like `bodies`
    const std::vector<JointHandle>& joints;
    const std::vector<TieHandle>& ties;
    const std::vector<CableHandle>& cables;
    const std::vector<CavityHandle>& cavities;
    const std::vector<SpringHandle>& springs;
};

decltype(RecordedProbe::what) recorded(const SeriesPlan& series, const Built& built) {
    const BodyHandle body = series.body ? built.bodies[*series.body] : BodyHandle{};
    switch (series.quantity) {
        case ProbeQuantity::motion:
            if (series.point) {
                PointProbe point{.body = body, .node = series.point->node, .weight = series.point->weight};
                Vec3 place = Vec3::Zero();
                for (std::size_t a = 0; a < 4; ++a)
                    place += point.weight[a] * built.world.positions(body)[static_cast<std::size_t>(point.node[a])];
                point.origin = place;
                return point;
            }
            return BodyProbe{body, built.world.center_of_mass(body)};
        case ProbeQuantity::force:
            if (series.collider) {
                ColliderForceProbe force{built.colliders[*series.collider]};
                if (series.by_body) force.by = built.bodies[*series.by_body];
                return force;
            } else {
                BodyForceProbe force{body};
                if (series.by_body) force.by = built.bodies[*series.by_body];
                if (series.by_collider) force.by = built.colliders[*series.by_collider];
                return force;
            }
        case ProbeQuantity::reaction:
            return ReactionProbe{built.pins[*series.body][series.pin]};
        case ProbeQuantity::joint:
            return JointProbe{built.joints[series.joint]};
        case ProbeQuantity::tie:
            return TieProbe{built.ties[series.tie]};
        case ProbeQuantity::cable:
            return CableProbe{built.cables[series.cable]};
        case ProbeQuantity::cavity:
            return CavityProbe{built.cavities[series.cavity]};
        case ProbeQuantity::spring:
            return SpringProbe{built.springs[series.spring]};
        case ProbeQuantity::stress:
            return StressProbe{body, series.nodes};
        case ProbeQuantity::volume:
            return VolumeProbe{body};
        case ProbeQuantity::contacts:  // recorded as Scene::probes, without a series
        case ProbeQuantity::energy:
            break;
    }
    return EnergyProbe{};
}

}  // namespace

namespace {

/// Adds a body with a mesh. If the world refuses a mesh that was read from a file, the error names this file.
BodyHandle add_mesh_body(const ScenePlan& plan, const BodyPlan& body, const BodySettings& settings, World& world) {
    const Mesh& mesh = plan.meshes[body.mesh];
    try {
        if (body.sets.empty()) return world.add_body(mesh, settings);
        Mesh with_sets = mesh;
        with_sets.sets.insert(body.sets.begin(), body.sets.end());
        return world.add_body(with_sets, settings);
    } catch (const SceneError&) {
        if (const std::filesystem::path& file = plan.mesh_files[body.mesh]; !file.empty())
            mesh.triangles.empty()
                ? mesh::require_positive(mesh, file.string())
                : mesh::require_shells({mesh.nodes, mesh.triangles}, file.string(), settings.inertia.has_value());
        throw;
    }
}

/// Gives each object in `objects` the name of the entry with the same index in `plans`.
template <class HandleType>
void name_objects(World& world, const std::vector<HandleType>& objects, const auto& plans) {
    for (std::size_t i = 0; i < objects.size(); ++i) name_object(world, objects[i], plans[i].name);
}

}  // namespace

Scene build_scene(const ScenePlan& plan, const std::function<void(std::size_t)>& added) {
    const Place top(plan.file);
    Scene scene{.name = plan.name,
                .description = plan.description,
                .materials = {},
                .seconds = plan.seconds,
                .frame_step = plan.frame_step,
                .world = called_at(top.key("settings"), [&] { return tuned_world(plan.settings, plan.tuning); }),
                .probes = {},
                .recorded = {},
                .probe_step = plan.probe_step,
                .notes = plan.notes};
    World& world = scene.world;

    for (const auto& [name, material] : plan.materials) scene.materials.push_back(name);
    std::vector<MaterialHandle> materials;
    for (const auto& [name, material] : plan.materials)
        materials.push_back(called_at(top.key("materials").key(name),
                                      [&, &settings = material] { return world.add_material(settings); }));
    std::vector<BodyHandle> bodies;
    std::vector<std::vector<AttachmentHandle>> pins;  // pins of each body, indexed like `bodies`
    std::vector<ColliderHandle> colliders;
    for (const BodyPlan& body : plan.bodies) {
        BodySettings settings = body.settings;
        settings.material = materials[body.material];
        for (const auto& [label, row] : body.materials) settings.materials.emplace(label, materials[row]);
        for (const auto& [set, row] : body.set_materials) settings.materials_of_sets.emplace(set, materials[row]);
        bodies.push_back(called_at(body.place, [&] {
            if (body.shape.sphere) return world.add_body(*body.shape.sphere, settings);
            if (body.shape.capsule) return world.add_body(*body.shape.capsule, settings);
            if (body.shape.cylinder) return world.add_body(*body.shape.cylinder, settings);
            return add_mesh_body(plan, body, settings, world);
        }));
        if (body.visual) set_bound_visual(world, bodies.back(), body.visual);
        if (added) added(bodies.size());
        pins.emplace_back();
        for (const PinPlan& pin : body.pins)
            pins.back().push_back(called_at(pin.place, [&] {
                return world.attach(bodies.back(), pin.nodes, pin.motion, pin.pivot, pin.directions);
            }));
    }
    for (const ColliderPlan& collider : plan.colliders)
        colliders.push_back(
            called_at(collider.place, [&] { return world.add_collider(collider.shape, collider.settings); }));
    SurfacePairs pairs(world);
    for (std::size_t c = 0; c < colliders.size(); ++c)
        if (plan.colliders[c].material) pairs.set_material(colliders[c], materials[*plan.colliders[c].material]);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (const SurfacePlan& surface : plan.bodies[b].surfaces) {
            SurfaceSetSettings settings = surface.settings;
            settings.body = bodies[b];
            called_at(surface.place, [&] { return SurfaceSets(world).add(settings); });
        }
    for (const PairPlan& pair : plan.pairs)
        called_at(pair.place, [&] { pairs.set(materials[pair.first], materials[pair.second], pair.surface); });
    for (const NoCollisionPlan& pair : plan.no_collision)
        if (pair.to_body)
            world.set_collision(bodies[pair.body], bodies[*pair.to_body], false);
        else
            world.set_collision(bodies[pair.body], colliders[*pair.to_collider], false);
    std::vector<JointHandle> joints;
    for (const JointPlan& joint : plan.joints) {
        JointSettings settings = joint.settings;
        settings.first = bodies[joint.first];
        if (joint.second) settings.second = bodies[*joint.second];
        joints.push_back(called_at(joint.place, [&] { return Joints(world).add(settings); }));
    }
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const JointPlan& joint = plan.joints[j];
        if (!joint.mimic) continue;
        const std::size_t leader = leader_of(joint, plan);
        called_at(joint.place.key("mimic"), [&] {
            Joints(world).set_mimic(joints[j], JointMimic{joints[leader], joint.mimic->ratio, joint.mimic->offset});
        });
    }
    std::vector<TieHandle> ties;
    for (const TiePlan& tie : plan.ties) {
        TieSettings settings = tie.settings;
        settings.body = bodies[tie.body];
        if (tie.to_body) settings.to_body = bodies[*tie.to_body];
        if (tie.to_collider) settings.to_collider = colliders[*tie.to_collider];
        ties.push_back(called_at(tie.place, [&] { return Ties(world).add(settings); }));
    }
    const PlannedHandles handles{bodies, colliders, pins};
    std::vector<CableHandle> cables;
    for (const CablePlan& cable : plan.cables)
        cables.push_back(called_at(cable.place, [&] {
            CableSettings settings = cable.settings;
            for (const AnchorPlan& point : cable.points)
                settings.points.push_back(anchor_of(point, plan, world, handles));
            return Cables(world).add(settings);
        }));
    const std::vector<CavityHandle> cavities = add_cavities(plan, bodies, world);
    for (const LoadPlan& load : plan.loads)
        name_object(world, called_at(load.place, [&] { return add_planned(load, bodies, world); }), load.name);
    for (const FibrePlan& fibres : plan.fibres) {
        FibreSettings settings = fibres.settings;
        settings.body = bodies[fibres.body];
        name_object(world, called_at(fibres.place, [&] { return Fibres(world).add(settings); }), fibres.name);
    }
    std::vector<SpringHandle> springs;
    for (const SpringPlan& spring : plan.springs) {
        SpringSettings settings = spring.settings;
        settings.first = anchor_of(spring.first, plan, world, handles);
        settings.second = anchor_of(spring.second, plan, world, handles);
        springs.push_back(called_at(spring.place, [&] { return Springs(world).add(settings); }));
    }
    name_objects(world, joints, plan.joints);
    name_objects(world, ties, plan.ties);
    name_objects(world, cables, plan.cables);
    name_objects(world, cavities, plan.cavities);
    name_objects(world, springs, plan.springs);
    scene.sliders = make_sliders(plan, handles, world);
    called_at(top, [&] { world.settle_start(); });
    for (const ProbePlan& probe : plan.probes) scene.probes.push_back({probe.name, bodies[probe.body], probe.nodes});
    const Built built{world, bodies, colliders, pins, joints, ties, cables, cavities, springs};
    for (const SeriesPlan& series : plan.series) scene.recorded.push_back({series.name, recorded(series, built)});
    return scene;
}

std::vector<BodyHandle> bodies_in_order(const World& world) {
    std::vector<BodyHandle> bodies = world.bodies();
    std::ranges::sort(bodies, {}, &BodyHandle::slot);  // slots ascend in the order of adding, as no body was removed
    return bodies;
}

Scene load_scene(const std::filesystem::path& file, const SceneOverrides& overrides,
                 const std::function<void(const std::string&)>& progress) {
    return build_scene(plan_scene(file, overrides, progress));
}

Scene load_scene_text(const std::string& json, const std::filesystem::path& folder, const SceneOverrides& overrides,
                      const std::function<void(const std::string&)>& progress) {
    const SceneFile scene = read_scene_text(json, folder, overrides.assignments);
    return build_scene(plan_scene(scene, scene_text_name, overrides, progress));
}

}  // namespace skerry
