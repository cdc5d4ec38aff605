// Plastic flow of elements, and its reset.
#include <algorithm>

#include "engine/world/kernels.h"
#include "engine/world/step/step.h"

namespace skerry {

Real yield_blocks(WorldState& world, const ElementInputs& elements, Range blocks) {
    Model& model = world.model;
    if (std::ranges::none_of(model.materials.constants, &MaterialConstants::yields)) return 0;
    Column<Real>& parts = world.scratch.plastic_parts;
    parts.resize((static_cast<std::size_t>(blocks.size()) + blocks_per_yield - 1) / blocks_per_yield);
    return kernels().yield_elements(*world.executor, elements, blocks, model.nodes.position,
                                    PlasticState::of(model.elements, model.element_nodes), parts);
}

bool has_flowed(const Model& model, std::size_t body) {
    return std::ranges::any_of(
        rows_of(model.elements.plastic_strain, model.bodies.blocks[body]),
        [](const auto& block) { return std::ranges::any_of(block.lane, [](Real strain) { return strain > 0; }); });
}

void undo_flow(Model& model, std::size_t body) {
    const std::span<const Vec3> rest = model.nodes.rest_position;
    kernels().forget_flow(model.all_elements(), model.bodies.blocks[body], rest, model.body_records[body].built,
                          PlasticState::of(model.elements, model.element_nodes));
}

}  // namespace skerry
