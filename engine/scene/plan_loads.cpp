// Finds the bodies and the parts of bodies on which loads act.
#include "engine/scene/scene_plan.h"

namespace skerry {

LoadPlan plan_load(const LoadEntry& entry, const ScenePlan& plan) {
    LoadPlan load{.name = entry.name, .place = entry.place};
    if (entry.body) load.body = find_body(plan, *entry.body, entry.place.key("body"));
    const TimeTable scale = entry.scale.value_or(TimeTable(1));
    switch (entry.kind) {
        case LoadKind::force:
            load.load = ForceLoad{
                .nodes = nodes_of(entry, plan.bodies[*load.body], plan), .force = *entry.force, .scale = scale};
            break;
        case LoadKind::traction:
            load.load = TractionLoad{.faces = faces_of(entry, plan.bodies[*load.body], plan),
                                     .traction = *entry.traction,
                                     .scale = scale,
                                     .area = entry.area.value_or(LoadArea::reference)};
            break;
        case LoadKind::acceleration:
            load.load = AccelerationField{.acceleration = *entry.acceleration, .scale = scale};
            break;
        case LoadKind::gravity:
            load.load = GravityScale{.scale = scale};
            break;
        case LoadKind::drag:
            load.load = DragField{.rate = *entry.rate, .wind = entry.wind.value_or(Vec3(Vec3::Zero())), .scale = scale};
            break;
    }
    return load;
}

LoadHandle add_planned(const LoadPlan& plan, std::span<const BodyHandle> bodies, World& world) {
    return std::visit(
        [&](auto load) {
            if (plan.body) load.body = bodies[*plan.body];
            return Loads(world).add(load);
        },
        plan.load);
}

}  // namespace skerry
