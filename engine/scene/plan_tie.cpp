// Resolves the names and nodes of ties.
#include "engine/scene/scene_plan.h"

namespace skerry {

TiePlan plan_tie(const TieEntry& entry, const ScenePlan& plan) {
    TiePlan tie;
    tie.body = find_body(plan, entry.body, entry.place.key("body"));
    if (entry.to_body) tie.to_body = find_body(plan, *entry.to_body, entry.place.key("to_body"));
    if (entry.to_collider) tie.to_collider = find_collider(plan, *entry.to_collider, entry.place.key("to_collider"));
    tie.settings.kind = entry.kind;
    tie.settings.nodes = nodes_of(entry, plan.bodies[tie.body], plan);
    if (entry.break_force) tie.settings.break_force = *entry.break_force;
    tie.settings.close_gap = entry.close_gap;
    tie.settings.bodies_touch = entry.bodies_touch;
    tie.place = entry.place;
    return tie;
}

}  // namespace skerry
