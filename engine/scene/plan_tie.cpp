// Resolves the names and nodes of ties.
#include <algorithm>

#include "engine/scene/scene_plan.h"

namespace skerry {

TiePlan plan_tie(const TieEntry& entry, std::size_t number, const ScenePlan& plan) {
    TiePlan tie;
    tie.name = entry.name.empty() ? "tie_" + std::to_string(number) : entry.name;
    if (std::ranges::find(plan.ties, tie.name, &TiePlan::name) != plan.ties.end())
        entry.place.key("name").refuse(in_quotes(tie.name) + ", which is already the name of a tie",
                                       "a different name for every tie");
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

std::size_t find_tie(const ScenePlan& plan, const std::string& name, const Place& place) {
    const auto found = std::ranges::find(plan.ties, name, &TiePlan::name);
    if (found != plan.ties.end()) return static_cast<std::size_t>(found - plan.ties.begin());
    std::vector<std::string> names;
    for (const TiePlan& tie : plan.ties) names.push_back(tie.name);
    place.refuse(in_quotes(name), names.empty() ? "the name of a tie, but the scene has no ties" : "the name of a tie",
                 nearest_hint(name, names));
}

}  // namespace skerry
