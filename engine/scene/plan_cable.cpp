// Resolves the names of bodies and colliders that cables use.
#include <algorithm>

#include "engine/scene/scene_plan.h"

namespace skerry {

CablePlan plan_cable(const CableEntry& entry, std::size_t number, const ScenePlan& plan) {
    CablePlan cable{.name = entry.name.empty() ? "cable_" + std::to_string(number) : entry.name};
    if (std::ranges::find(plan.cables, cable.name, &CablePlan::name) != plan.cables.end())
        entry.place.key("name").refuse(in_quotes(cable.name) + ", which is already the name of a cable",
                                       "a different name for every cable");
    for (const AnchorEntry& point : entry.points) cable.points.push_back(plan_anchor(point, plan));
    cable.settings.drive = {.tension = entry.tension, .length = entry.length, .rate = entry.rate};
    cable.settings.friction = entry.friction;
    cable.place = entry.place;
    return cable;
}

}  // namespace skerry
