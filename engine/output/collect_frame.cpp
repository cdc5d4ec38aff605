#include "engine/output/collect_frame.h"

#include <algorithm>

#include "engine/estimate/mesh_error.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/objects.h"
#include "engine/world/elements_of_body.h"
#include "engine/world/world_state.h"
#include "jobs/parallel_for.h"

namespace skerry {

namespace {

/// Returns the index of the material of each cell of a body: of each tetrahedron or, without tetrahedra, of each
/// triangle.
std::vector<Index> materials_of(const World& world, BodyHandle body) {
    const Model& model = WorldAccess::state_of(world).model;
    const auto row = static_cast<std::size_t>(model.row(body, "frame"));
    const BodyRecord& record = model.body_records[row];
    if (!record.tetrahedron_material.empty()) return record.tetrahedron_material;
    return std::vector<Index>(record.tetrahedra.empty() ? record.surface.size() : record.tetrahedra.size(),
                              model.bodies.material[row]);
}

const BoundVisual* visual_of(const World& world, BodyHandle body) {
    const Model& model = WorldAccess::state_of(world).model;
    return model.body_records[static_cast<std::size_t>(model.row(body, "frame"))].visual.get();
}

/// Returns a value for each cell of a body, given the values of its tetrahedra. In a body without tetrahedra, which is
/// rigid, the cells are triangles, and each gets the value `zero`.
template <class T>
std::vector<T> values_of_cells(std::vector<T> of_tetrahedra, const BodyFrame& body, const T& zero) {
    of_tetrahedra.resize(body.count_cells(), zero);
    return of_tetrahedra;
}

}  // namespace

Frame collect_frame(const World& world, FrameContent content) {
    Frame frame{.time = world.time(),
                .gravity = world.settings().gravity,
                .energy = content >= FrameContent::mesh_error ? world.energy() : Energy{},
                .bodies = {},
                .colliders = {},
                .contacts = world.contacts(),
                .lines = collect_lines(world)};
    const std::vector<BodyHandle> bodies = world.bodies();
    const Model& model = WorldAccess::state_of(world).model;
    const bool yields = std::ranges::any_of(model.materials.constants, &MaterialConstants::yields);
    std::vector<MeshError> fields(bodies.size());
    if (content >= FrameContent::node_fields)
        parallel_for(*WorldAccess::state_of(world).executor, bodies.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t b = begin; b < end; ++b)
                if (const auto row = static_cast<std::size_t>(model.row(bodies[b], "frame"));
                    content == FrameContent::node_fields)
                    fields[b].nodes = fields_of_nodes(model, row, all_nodes(model, row));
                else
                    fields[b] = measure_mesh_error(world, bodies[b]);
        });
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const BodyHandle body = bodies[b];
        BodyFrame& of_body = frame.bodies.emplace_back(BodyFrame{.handle = body,
                                                                 .name = world.name(body),
                                                                 .position = world.positions(body),
                                                                 .velocity = world.velocities(body),
                                                                 .surface = world.surface(body),
                                                                 .tetrahedra = world.tetrahedra(body),
                                                                 .stress = {},
                                                                 .strain = {},
                                                                 .plastic_strain = {},
                                                                 .node_stress = std::move(fields[b].nodes.stress),
                                                                 .node_strain = std::move(fields[b].nodes.strain),
                                                                 .node_mesh_error = std::move(fields[b].of_nodes)});
        of_body.visual = visual_of(world, body);
        if (world.dynamics(body) == BodyDynamics::rigid) of_body.rigid_pose = world.pose(body);
        if (content < FrameContent::cell_values) continue;
        of_body.material = materials_of(world, body);
        of_body.stress = values_of_cells<Mat3>(world.stress(body), of_body, Mat3::Zero());
        of_body.strain = values_of_cells<Mat3>(world.strain(body), of_body, Mat3::Zero());
        if (yields) of_body.plastic_strain = values_of_cells<Real>(world.plastic_strain(body), of_body, 0);
    }
    for (const ColliderHandle collider : world.colliders())
        frame.colliders.push_back({.handle = collider,
                                   .name = world.name(collider),
                                   .shape = &world.shape(collider),
                                   .pose = world.pose(collider)});
    if (content < FrameContent::cell_values) return frame;
    for (const FibreHandle fibres : handles_of<FibreHandle>(model)) {
        const FibreState state = fibre_state(WorldAccess::state_of(world), fibres);
        BodyFrame& body = *std::ranges::find(frame.bodies, state.body, &BodyFrame::handle);
        body.fibre_stretch.resize(body.count_cells(), 1);
        body.fibre_stress.resize(body.count_cells(), 0);
        for (std::size_t t = 0; t < state.tetrahedra.size(); ++t) {
            const auto cell = static_cast<std::size_t>(state.tetrahedra[t]);
            body.fibre_stretch[cell] = state.stretch[t];
            body.fibre_stress[cell] = state.stress[t];
        }
    }
    return frame;
}

}  // namespace skerry
