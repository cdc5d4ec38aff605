// Resolves the names of springs in a scene.
#include <algorithm>

#include "engine/scene/scene_plan.h"

namespace skerry {

void plan_spring(const SpringEntry& entry, std::size_t number, ScenePlan& plan) {
    SpringPlan spring;
    spring.name = entry.name.empty() ? "spring_" + std::to_string(number) : entry.name;
    if (std::ranges::find(plan.springs, spring.name, &SpringPlan::name) != plan.springs.end())
        entry.place.key("name").refuse(in_quotes(spring.name) + ", which is already the name of a spring",
                                       "a different name for every spring");
    spring.first = plan_anchor(entry.first, plan);
    spring.second = plan_anchor(entry.second, plan);
    spring.settings.stiffness = entry.stiffness;
    spring.settings.damping = entry.damping;
    spring.settings.rest_length = entry.rest_length;
    spring.settings.only = entry.only;
    spring.settings.strength = entry.strength.value_or(infinity);
    spring.place = entry.place;
    plan.springs.push_back(std::move(spring));
}

std::size_t find_spring(const ScenePlan& plan, const std::string& name, const Place& place) {
    const auto found = std::ranges::find(plan.springs, name, &SpringPlan::name);
    if (found != plan.springs.end()) return static_cast<std::size_t>(found - plan.springs.begin());
    std::vector<std::string> names;
    for (const SpringPlan& spring : plan.springs) names.push_back(spring.name);
    place.refuse(in_quotes(name),
                 names.empty() ? "the name of a spring, but the scene has no springs" : "the name of a spring",
                 nearest_hint(name, names));
}

}  // namespace skerry
