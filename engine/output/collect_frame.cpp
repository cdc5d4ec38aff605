#include "engine/output/collect_frame.h"

#include "engine/world/node_fields.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

/// Returns the material of each tetrahedron of a body.
std::vector<Index> materials_of(const World& world, BodyHandle body) {
    const Model& model = WorldAccess::state_of(world).model;
    const auto row = static_cast<std::size_t>(model.row(body, "frame"));
    const BodyRecord& record = model.body_records[row];
    if (!record.tetrahedron_material.empty()) return record.tetrahedron_material;
    return std::vector<Index>(record.tetrahedra.size(), model.bodies.material[row]);
}

}  // namespace

Frame collect_frame(const World& world) {
    const WorldReport report = world.report();
    Frame frame{.time = report.time,
                .gravity = world.settings().gravity,
                .energy = report.energy,
                .bodies = {},
                .colliders = {},
                .contacts = world.contacts()};
    for (const BodyHandle body : world.bodies()) {
        NodeFields of_nodes = node_fields(world, body);
        frame.bodies.push_back({.handle = body,
                                .name = world.name(body),
                                .position = world.positions(body),
                                .velocity = world.velocities(body),
                                .surface = world.surface(body),
                                .tetrahedra = world.tetrahedra(body),
                                .stress = world.stress(body),
                                .strain = world.strain(body),
                                .node_stress = std::move(of_nodes.stress),
                                .node_strain = std::move(of_nodes.strain),
                                .material = materials_of(world, body)});
    }
    for (const ColliderHandle collider : world.colliders())
        frame.colliders.push_back({.handle = collider,
                                   .name = world.name(collider),
                                   .shape = &world.shape(collider),
                                   .pose = world.pose(collider)});
    return frame;
}

}  // namespace skerry
