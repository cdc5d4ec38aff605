// Names of the objects of a scene.
#include <algorithm>

#include "engine/scene/scene_plan.h"

namespace skerry {

std::size_t find_name(std::span<const std::string_view> names, const std::string& name, const std::string& kind,
                      const Place& place) {
    const auto found = std::ranges::find(names, name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const std::string all = kind.ends_with("y") ? kind.substr(0, kind.size() - 1) + "ies" : kind + "s";
    place.refuse(in_quotes(name),
                 "the name of a " + kind + (names.empty() ? ", but the scene has no " + all : std::string()),
                 nearest_hint(name, std::vector<std::string>(names.begin(), names.end())));
}

std::string choose_name(const std::string& name, std::span<const std::string_view> taken, const std::string& kind,
                        const Place& place) {
    const std::string chosen = name.empty() ? kind + "_" + std::to_string(taken.size()) : name;
    if (std::ranges::find(taken, chosen) != taken.end())
        place.key("name").refuse(in_quotes(chosen) + ", which is already the name of a " + kind,
                                 "a different name for every " + kind);
    return chosen;
}

std::size_t find_body(const ScenePlan& plan, const std::string& name, const Place& place) {
    return find_name(names_of(plan.bodies), name, "body", place);
}

std::size_t find_collider(const ScenePlan& plan, const std::string& name, const Place& place) {
    return find_name(names_of(plan.colliders), name, "collider", place);
}

}  // namespace skerry
