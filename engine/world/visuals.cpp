#include "engine/world/visuals.h"

#include <utility>

#include "engine/world/validate.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

std::size_t row_of_visual(WorldState& state, BodyHandle body, const char* call) {
    state.settle();
    return static_cast<std::size_t>(state.model.row(body, call));
}

}  // namespace

void set_bound_visual(World& world, BodyHandle body, std::shared_ptr<const BoundVisual> visual) {
    WorldState& state = WorldAccess::state_of(world);
    state.require_between_steps("set_visual");
    state.model.body_records[row_of_visual(state, body, "set_visual")].visual = std::move(visual);
}

VisualFit Visuals::set(BodyHandle body, VisualSurface surface) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_visual");
    const std::size_t row = row_of_visual(state, body, "set_visual");
    const BodyRecord& record = state.model.body_records[row];
    require_visual(surface, "visual surface of body '" + record.name + "'");
    auto visual = std::make_shared<const BoundVisual>(
        bind_visual(std::move(surface), state.model.mesh_shape(row), record.tetrahedra, record.surface));
    set_bound_visual(*world_, body, visual);
    return visual->fit;
}

void Visuals::remove(BodyHandle body) {
    set_bound_visual(*world_, body, nullptr);
}

const VisualSurface* Visuals::get(BodyHandle body) const {
    WorldState& state = WorldAccess::state_of(*world_);
    const BoundVisual* const visual = state.model.body_records[row_of_visual(state, body, "visual")].visual.get();
    return visual ? &visual->surface : nullptr;
}

VisualFit Visuals::fit(BodyHandle body) const {
    WorldState& state = WorldAccess::state_of(*world_);
    const BodyRecord& record = state.model.body_records[row_of_visual(state, body, "visual")];
    if (!record.visual) refuse("body '" + record.name + "'", "visual", "none", "a body with a visual surface");
    return record.visual->fit;
}

std::vector<Vec3> Visuals::positions(BodyHandle body) const {
    WorldState& state = WorldAccess::state_of(*world_);
    const BoundVisual* const visual = state.model.body_records[row_of_visual(state, body, "visual")].visual.get();
    return visual ? visual_positions(*visual, world_->positions(body)) : std::vector<Vec3>();
}

}  // namespace skerry
