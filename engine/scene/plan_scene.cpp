#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "components/split_mix.h"
#include "engine/mesh/labels.h"
#include "engine/scene/make_mesh.h"
#include "engine/scene/mesh_levels.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

Mesh picture_of(const BodyShapeEntry& shape) {
    if (shape.sphere) return mesh::sphere_picture(shape.sphere->radius);
    if (shape.capsule) return mesh::capsule_picture(shape.capsule->radius, shape.capsule->length);
    return mesh::cylinder_picture(shape.cylinder->radius, shape.cylinder->height);
}

Shape make_collider_shape(const ShapeEntry& entry, std::vector<std::string>& notes, const SurfaceFilling& filling) {
    if (entry.plane) return *entry.plane;
    if (entry.sphere) return *entry.sphere;
    if (entry.box) return *entry.box;
    if (entry.capsule) return *entry.capsule;
    if (entry.cylinder) return *entry.cylinder;
    if (entry.bucket) return *entry.bucket;
    return make_surface(*entry.mesh, notes, filling);
}

Motion make_motion(const MotionEntry& entry) {
    Motion motion{.velocity = entry.velocity, .angular_velocity = entry.angular_velocity, .keys = {}};
    for (const KeyEntry& key : entry.keys) motion.keys.push_back({key.time, key.position, key.rotation.value});
    return motion;
}

/// Directions along which a pin holds its nodes; empty: all directions.
std::vector<Vec3> held_directions(const PinEntry& entry) {
    if (entry.direction) return {*entry.direction};
    std::vector<Vec3> directions;
    if (!entry.axes) return directions;
    for (const WorldAxis axis : *entry.axes) directions.push_back(Vec3::Unit(static_cast<Index>(axis)));
    if (directions.empty()) entry.place.key("axes").refuse("an empty list", "at least one of \"x\", \"y\", \"z\"");
    return directions;
}

PinPlan plan_pin(const PinEntry& entry, const PlannedMesh& mesh, const std::map<std::string, MeshSet>& sets) {
    return {.nodes = nodes_of(entry, mesh, sets),
            .motion = make_motion(entry.motion),
            .pivot = entry.pivot,
            .directions = held_directions(entry),
            .place = entry.place};
}

/// Friction and restitution of an entry of a scene file.
SurfaceSettings surface_of(const auto& entry) {
    return {.friction = entry.friction,
            .static_friction = entry.static_friction,
            .dynamic_friction = entry.dynamic_friction,
            .restitution = entry.restitution};
}

SurfacePlan plan_surface(const SurfaceEntry& entry, const PlannedMesh& mesh,
                         const std::map<std::string, MeshSet>& sets) {
    SurfacePlan surface{.settings = {.surface = surface_of(entry),
                                     .friction_across = entry.friction_across,
                                     .direction = entry.direction},
                        .place = entry.place};
    if (entry.set) {
        // The nodes are given in addition to the faces: a listed node belongs to the surface set even if it has no face
        // whose nodes are all listed.
        const MeshSet& set = find_set(*entry.set, mesh, sets, entry.place.key("set"));
        surface.settings.nodes = set.nodes;
        surface.settings.faces = faces_of(set, mesh);
    } else {
        surface.settings.nodes = nodes_of(entry, mesh, sets);
    }
    return surface;
}

}  // namespace

std::vector<Vec3> positions_of(const BodyEntry& entry) {
    std::vector<Vec3> positions = entry.positions;
    if (entry.repeat) {
        const RepeatEntry& grid = *entry.repeat;
        SplitMix random(static_cast<std::uint64_t>(grid.seed));
        for (int k = 0; k < grid.count[2]; ++k)
            for (int j = 0; j < grid.count[1]; ++j)
                for (int i = 0; i < grid.count[0]; ++i) {
                    Vec3 position = entry.position + grid.spacing.cwiseProduct(Vec3(i, j, k));
                    for (Index axis = 0; axis < 3; ++axis) position[axis] += grid.jitter * random.symmetric();
                    positions.push_back(position);
                }
    }
    if (positions.empty()) positions.push_back(entry.position);
    return positions;
}

namespace {

std::size_t find_material(const ScenePlan& plan, const std::string& wanted, const Place& place) {
    std::vector<std::string> names;
    for (const auto& [name, material] : plan.materials) names.push_back(name);
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found == names.end())
        place.refuse(in_quotes(wanted),
                     names.empty() ? "the name of a material, but the scene defines no materials"
                                   : "one of the materials " + listed(names),
                     nearest_hint(wanted, names));
    return static_cast<std::size_t>(found - names.begin());
}

/// Resolves the key `materials` of a body: a key that is a whole number is a label, any other key is the name of a set.
void plan_materials(const BodyEntry& entry, const Mesh& mesh, const ScenePlan& plan, BodyPlan& body) {
    const std::map<int, std::size_t> labels = mesh::count_labels(mesh);
    for (const auto& [key, name] : entry.materials.items) {
        const Place place = entry.place.key("materials").key(key);
        int label = 0;
        const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), label);
        if (error != std::errc{} || end != key.data() + key.size() || std::to_string(label) != key) {
            if (!mesh.sets.contains(key) && !body.sets.contains(key))
                place.refuse("the key " + in_quotes(key),
                             mesh::expected_label(mesh) + ", or " + expected_set(mesh, body.sets));
            body.set_materials.emplace_back(key, find_material(plan, name, place));
            continue;
        }
        if (!labels.contains(label))
            place.refuse(
                "label " + key, mesh::expected_label(mesh),
                labels.empty() ? "use a mesh file with labels, or name a set of tetrahedra (scenes/README.md)" : "");
        body.materials.emplace_back(label, find_material(plan, name, place));
    }
}

/// Names, mesh files and visual surfaces of the bodies that have been planned so far.
struct PlannedBodies {
    std::set<std::string> names;
    // Index in ScenePlan::meshes of each mesh file or filled surface. Key: file; true if it is a surface to fill; true
    // if it is a mesh file of a rigid body; `scale`, `edge`, `tolerance`, `cavities` and `refine` of the MeshEntry.
    std::map<std::tuple<std::filesystem::path, bool, bool, Real, std::optional<Real>, std::optional<Real>, bool, int>,
             std::size_t>
        mesh_of_file;
    // Visual surfaces. Key: path and scale of the file, and index of the mesh in ScenePlan::meshes.
    std::map<std::tuple<std::filesystem::path, Real, std::size_t>, std::shared_ptr<const BoundVisual>> visuals;
    const SurfaceFilling& filling;
};

/// Adds the mesh of a body to plan.meshes, unless another body with an equal entry for a file has already added it.
/// Returns the index of the mesh.
std::size_t plan_mesh(const BodyEntry& entry, PlannedBodies& so_far, ScenePlan& plan) {
    const std::size_t next = plan.meshes.size();
    const bool rigid = entry.dynamics == BodyDynamics::rigid;
    if (!entry.mesh || !(entry.mesh->file || entry.mesh->surface)) {
        plan.meshes.push_back(entry.mesh ? make_mesh(*entry.mesh, rigid, plan.notes, so_far.filling)
                                         : PlannedMesh{picture_of(*entry.shape)});
        plan.mesh_files.emplace_back();
        return next;
    }
    const MeshEntry& mesh = *entry.mesh;
    const std::filesystem::path& file = (mesh.file ? mesh.file : mesh.surface)->path;
    const bool filled = mesh.surface.has_value();
    const auto [known, is_new] = so_far.mesh_of_file.try_emplace(
        {file, filled, rigid && !filled, mesh.scale, mesh.edge, mesh.tolerance, mesh.cavities, mesh.refine}, next);
    if (!is_new) return known->second;
    plan.meshes.push_back(make_mesh(mesh, rigid, plan.notes, so_far.filling));
    plan.mesh_files.push_back(file);
    return next;
}

/// Returns the visual surface of an entry, bound to the mesh `of_plan`. Entries with equal file, scale and mesh share
/// one surface. `of_plan`: index in ScenePlan::meshes.
std::shared_ptr<const BoundVisual> plan_visual(const BodyEntry& entry, const std::string& name, std::size_t of_plan,
                                               PlannedBodies& so_far, ScenePlan& plan) {
    const VisualEntry& visual = *entry.visual;
    const Real scale = visual.scale.value_or(entry.mesh ? entry.mesh->scale : 1);
    std::shared_ptr<const BoundVisual>& bound = so_far.visuals[{visual.file.path, scale, of_plan}];
    if (bound) return bound;
    VisualSurface surface =
        called_at(visual.place, [&] { return mesh::read_visual(visual.file.path.string(), &plan.notes); });
    for (Vec3& node : surface.nodes) node *= scale;
    const Mesh& mesh = plan.meshes[of_plan];
    bound = std::make_shared<const BoundVisual>(
        bind_visual(std::move(surface), mesh.nodes, mesh.tetrahedra, mesh.triangles));
    if (!bound->fit.warning.empty()) plan.notes.push_back("body '" + name + "': " + bound->fit.warning);
    return bound;
}

void plan_body(const BodyEntry& entry, std::size_t number, PlannedBodies& so_far, ScenePlan& plan) {
    const std::size_t material = find_material(plan, entry.material, entry.place.key("material"));
    const std::size_t of_plan = plan_mesh(entry, so_far, plan);
    const PlannedMesh& mesh = plan.meshes[of_plan];
    if (entry.shape && !entry.sets.items.empty())
        entry.place.key("sets").refuse("sets of a body without a mesh", "a body with \"mesh\"");
    BodyPlan planned;
    planned.sets = plan_sets(entry.sets, mesh, entry.place.key("sets"));
    plan_materials(entry, mesh, plan, planned);
    for (const PinEntry& pin : entry.pin.items) planned.pins.push_back(plan_pin(pin, mesh, planned.sets));
    for (const SurfaceEntry& surface : entry.surfaces)
        planned.surfaces.push_back(plan_surface(surface, mesh, planned.sets));

    const std::string name = entry.name.empty() ? "body_" + std::to_string(number) : entry.name;
    if (entry.visual) planned.visual = plan_visual(entry, name, of_plan, so_far, plan);
    const bool copies = entry.repeat || !entry.positions.empty();
    const std::vector<Vec3> positions = positions_of(entry);
    for (std::size_t copy = 0; copy < positions.size(); ++copy) {
        BodyPlan body = planned;
        body.settings.position = positions[copy];
        body.settings.rotation = entry.rotation.value;
        body.settings.velocity = entry.velocity;
        body.settings.angular_velocity = entry.angular_velocity;
        body.settings.contact_distance = entry.contact_distance;
        body.settings.self_contact = entry.self_contact;
        // The engine does not choose the dynamics of bodies with pinned nodes: World::attach() makes such a body
        // explicit. The plan also says explicit, because stiff_note() proposes implicit dynamics only for bodies whose
        // planned dynamics are not automatic.
        body.settings.dynamics = entry.dynamics == BodyDynamics::automatic && !planned.pins.empty()
                                     ? BodyDynamics::explicit_elastic
                                     : entry.dynamics;
        body.settings.mass = entry.mass;
        body.settings.center_of_mass = entry.center_of_mass;
        if (entry.inertia) {
            Mat3& inertia = body.settings.inertia.emplace();
            for (std::size_t row = 0; row < 3; ++row) inertia.row(static_cast<Index>(row)) = (*entry.inertia)[row];
        }
        body.settings.collision_group = entry.collision_group;
        body.settings.collision_mask = entry.collision_mask;
        body.settings.element = entry.element;
        body.settings.name = copies ? name + "_" + std::to_string(copy) : name;
        body.mesh = of_plan;
        if (entry.shape) body.shape = *entry.shape;
        body.material = material;
        body.place = entry.place;
        if (!so_far.names.insert(body.settings.name).second)
            entry.place.key("name").refuse(in_quotes(body.settings.name) + ", which is already the name of a body",
                                           "a different name for every body");
        plan.bodies.push_back(std::move(body));
    }
}

ColliderPlan plan_collider(const ColliderEntry& entry, std::size_t number, const SurfaceFilling& filling,
                           ScenePlan& plan) {
    ColliderPlan collider;
    collider.shape = make_collider_shape(entry.shape, plan.notes, filling);
    if (entry.material) collider.material = find_material(plan, *entry.material, entry.place.key("material"));
    collider.settings.position = entry.position;
    collider.settings.rotation = entry.rotation.value;
    collider.settings.motion = make_motion(entry.motion);
    collider.settings.friction = entry.friction;
    collider.settings.static_friction = entry.static_friction;
    collider.settings.dynamic_friction = entry.dynamic_friction;
    collider.settings.restitution = entry.restitution;
    collider.settings.contact_distance = entry.contact_distance;
    collider.settings.collision_group = entry.collision_group;
    collider.settings.collision_mask = entry.collision_mask;
    collider.settings.name = entry.name.empty() ? "collider_" + std::to_string(number) : entry.name;
    collider.place = entry.place;
    return collider;
}

PairPlan plan_pair(const PairEntry& entry, const ScenePlan& plan) {
    const Place place = entry.place.key("materials");
    return {.first = find_material(plan, entry.materials[0], place.item(0)),
            .second = find_material(plan, entry.materials[1], place.item(1)),
            .surface = surface_of(entry),
            .place = entry.place};
}

/// Adds a pair of materials. Throws SceneError for a second entry with the same two materials. plan.materials must be
/// complete.
void plan_pair_once(const PairEntry& entry, ScenePlan& plan) {
    const PairPlan pair = plan_pair(entry, plan);
    const auto is_same = [&](const PairPlan& other) {
        return std::minmax(other.first, other.second) == std::minmax(pair.first, pair.second);
    };
    if (std::ranges::any_of(plan.pairs, is_same))
        entry.place.key("materials")
            .refuse("a second pair of " + in_quotes(entry.materials[0]) + " and " + in_quotes(entry.materials[1]),
                    "every pair of materials at most once", "delete one of the two entries");
    plan.pairs.push_back(pair);
}

NoCollisionPlan plan_no_collision(const NoCollisionEntry& entry, const ScenePlan& plan) {
    NoCollisionPlan pair{
        .body = find_body(plan, entry.body, entry.place.key("body")), .to_body = {}, .to_collider = {}};
    if (entry.to_body) pair.to_body = find_body(plan, *entry.to_body, entry.place.key("to_body"));
    if (entry.to_collider) pair.to_collider = find_collider(plan, *entry.to_collider, entry.place.key("to_collider"));
    return pair;
}

JointPlan plan_joint(const JointEntry& entry, const ScenePlan& plan) {
    JointPlan joint;
    joint.name = choose_name(entry.name, names_of(plan.joints), "joint", entry.place);
    joint.first = find_body(plan, entry.first, entry.place.key("first"));
    if (entry.second) joint.second = find_body(plan, *entry.second, entry.place.key("second"));
    joint.settings.kind = entry.kind;
    joint.settings.point = entry.point;
    joint.settings.axis = entry.axis;
    joint.settings.coordinate = entry.coordinate;
    joint.settings.lower = entry.lower;
    joint.settings.upper = entry.upper;
    joint.settings.passive = entry.passive;
    joint.settings.bodies_touch = entry.bodies_touch;
    if (entry.motor) {
        joint.settings.motor = JointMotor{.speed = entry.motor->speed,
                                          .position = entry.motor->position,
                                          .strength = entry.motor->strength,
                                          .keys = entry.motor->keys};
        if (entry.motor->fastest) joint.settings.motor->fastest = *entry.motor->fastest;
    }
    joint.mimic = entry.mimic;
    joint.place = entry.place;
    return joint;
}

}  // namespace

std::size_t leader_of(const JointPlan& joint, const ScenePlan& plan) {
    return find_name(names_of(plan.joints), joint.mimic->joint, "joint", joint.place.key("mimic").key("joint"));
}

namespace {

/// Adds a note if a joint does not start at the coordinate that its MimicEntry prescribes: ratio * (start coordinate of
/// the joint that it follows) + offset.
void note_start_of_mimic(const JointPlan& joint, ScenePlan& plan) {
    const JointPlan& leader = plan.joints[leader_of(joint, plan)];
    const Real found = joint.settings.coordinate,
               wanted = joint.mimic->ratio * leader.settings.coordinate + joint.mimic->offset;
    constexpr Real rounding = 1e-6;
    if (!(std::abs(found - wanted) > rounding * std::max(Real(1), std::abs(wanted)))) return;
    plan.notes.push_back("joint " + in_quotes(joint.name) + " starts at the coordinate " + Json(found).dump() +
                         ", and by its mimic of " + in_quotes(leader.name) + " it should start at " +
                         Json(wanted).dump() + "; the run moves both there at a limited speed");
}

void apply(const SceneOverrides& overrides, Settings& settings) {
    if (overrides.threads) settings.threads = *overrides.threads;
    if (overrides.backend) settings.backend = *overrides.backend;
    if (overrides.contact_regions) settings.contact_regions = *overrides.contact_regions;
    if (overrides.method) settings.method = *overrides.method;
    if (overrides.friction) settings.friction = *overrides.friction;
    if (overrides.tolerance) settings.tolerance = *overrides.tolerance;
    if (overrides.max_iterations) settings.max_iterations = *overrides.max_iterations;
    if (overrides.start_overlaps) settings.start_overlaps = *overrides.start_overlaps;
    if (overrides.step_size) settings.step_size = *overrides.step_size;
}

}  // namespace

ScenePlan plan_scene(const std::filesystem::path& file, const SceneOverrides& overrides,
                     const mesh::FillProgress& progress) {
    return plan_scene(read_scene_file(file, overrides.assignments), file, overrides, progress);
}

ScenePlan plan_scene(const SceneFile& scene, const std::filesystem::path& file, const SceneOverrides& overrides,
                     const mesh::FillProgress& progress) {
    ScenePlan plan;
    plan.file = file;
    plan.name = scene.name;
    plan.description = scene.description;
    plan.seconds = scene.seconds;
    plan.frame_step = scene.frame_step;
    plan.probe_step = scene.probe_step.value_or(scene.frame_step);
    plan.settings = scene.settings;
    apply(overrides, plan.settings);
    plan.materials = scene.materials.items;
    for (const PairEntry& pair : scene.pairs) plan_pair_once(pair, plan);
    require_levels(scene);
    const SurfaceFilling filling{progress, overrides.fill_python};
    PlannedBodies so_far{.names = {}, .mesh_of_file = {}, .visuals = {}, .filling = filling};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) plan_body(scene.bodies[i], i, so_far, plan);
    if (overrides.element)
        for (BodyPlan& body : plan.bodies) body.settings.element = *overrides.element;
    for (std::size_t i = 0; i < scene.colliders.size(); ++i)
        plan.colliders.push_back(plan_collider(scene.colliders[i], i, filling, plan));
    for (const NoCollisionEntry& pair : scene.no_collision) plan.no_collision.push_back(plan_no_collision(pair, plan));
    for (const JointEntry& joint : scene.joints) plan.joints.push_back(plan_joint(joint, plan));
    for (const JointPlan& joint : plan.joints)
        if (joint.mimic) note_start_of_mimic(joint, plan);
    for (const TieEntry& tie : scene.ties) plan.ties.push_back(plan_tie(tie, plan));
    for (const CableEntry& cable : scene.cables) plan.cables.push_back(plan_cable(cable, plan));
    plan_cavities(scene, plan);
    for (const LoadEntry& load : scene.loads) plan.loads.push_back(plan_load(load, plan));
    for (const FibreEntry& fibres : scene.fibres) plan.fibres.push_back(plan_fibres(fibres, plan));
    for (const SpringEntry& spring : scene.springs) plan.springs.push_back(plan_spring(spring, plan));
    for (const ProbeEntry& probe : scene.probes) plan_probe(probe, plan);
    plan.sliders = scene.sliders;
    return plan;
}

}  // namespace skerry
