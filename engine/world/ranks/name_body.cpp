// Names of bodies in reports. All ranks report the same name for a body.
#include "engine/world/step/step.h"

namespace skerry {

NamedBody name_body(const WorldState& world, Index world_row) {
    if (world_row == no_index) return {};
    const Model& model = world.model;
    const Index row = world.ranks.row_of(world_row);
    if (row == no_index) {
        const WholeWorld& whole = world.ranks.whole;
        return {whole.handle(model, world_row), whole.records[static_cast<std::size_t>(world_row)].name};
    }
    const auto b = static_cast<std::size_t>(row);
    // Bodies that are not deformable are the meshes of mesh colliders. They have no body handle.
    const bool has_handle = model.bodies.kind[b] == BodyKind::deformable;
    return {has_handle ? model.body_map.handle_of_slot(model.bodies.slot[b]) : BodyHandle{},
            model.body_records[b].name};
}

Index world_row_of_stiffest(const WorldState& world, Index row) {
    return row == no_index ? world.model.of_ranks.stiffest : world.ranks.world_row_of(row);
}

}  // namespace skerry
