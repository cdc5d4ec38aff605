// Resolves the names of bodies and cavities that cavities and pipes use, and adds them to a world.
#include <algorithm>

#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

CavityPlan plan_cavity(const CavityEntry& entry, std::size_t number, const ScenePlan& plan) {
    CavityPlan cavity;
    cavity.place = entry.place;
    cavity.name = entry.name.empty() ? "cavity_" + std::to_string(number) : entry.name;
    if (std::ranges::find(plan.cavities, cavity.name, &CavityPlan::name) != plan.cavities.end())
        entry.place.key("name").refuse(in_quotes(cavity.name) + ", which is already the name of a cavity",
                                       "a different name for every cavity");
    cavity.body = find_body(plan, entry.body, entry.place.key("body"));
    if (entry.set || entry.box || !entry.nodes.empty())
        cavity.settings.faces = faces_of(entry, plan.bodies[cavity.body], plan);
    if (entry.pressure) cavity.settings.filling = *entry.pressure;
    if (entry.gas) cavity.settings.filling = *entry.gas;
    if (entry.liquid) cavity.settings.filling = *entry.liquid;
    cavity.settings.volume = entry.volume;
    return cavity;
}

PipePlan plan_pipe(const PipeEntry& entry, const ScenePlan& plan) {
    PipePlan pipe;
    pipe.name = entry.name;
    pipe.place = entry.place;
    pipe.first = find_cavity(plan, entry.first, entry.place.key("first"));
    if (entry.second) pipe.second = find_cavity(plan, *entry.second, entry.place.key("second"));
    pipe.settings.conductance = entry.conductance;
    if (entry.pressure) pipe.settings.pressure = *entry.pressure;
    return pipe;
}

}  // namespace

std::size_t find_cavity(const ScenePlan& plan, const std::string& name, const Place& place) {
    const auto found = std::ranges::find(plan.cavities, name, &CavityPlan::name);
    if (found != plan.cavities.end()) return static_cast<std::size_t>(found - plan.cavities.begin());
    std::vector<std::string> names;
    for (const CavityPlan& cavity : plan.cavities) names.push_back(cavity.name);
    place.refuse(in_quotes(name),
                 names.empty() ? "the name of a cavity, but the scene has no cavities" : "the name of a cavity",
                 nearest_hint(name, names));
}

void plan_cavities(const SceneFile& scene, ScenePlan& plan) {
    for (std::size_t i = 0; i < scene.cavities.size(); ++i)
        plan.cavities.push_back(plan_cavity(scene.cavities[i], i, plan));
    for (const PipeEntry& pipe : scene.pipes) plan.pipes.push_back(plan_pipe(pipe, plan));
}

std::vector<CavityHandle> add_cavities(const ScenePlan& plan, const std::vector<BodyHandle>& bodies, World& world) {
    std::vector<CavityHandle> handles;
    for (const CavityPlan& cavity : plan.cavities) {
        CavitySettings settings = cavity.settings;
        settings.body = bodies[cavity.body];
        handles.push_back(called_at(cavity.place, [&] { return Cavities(world).add(settings); }));
    }
    for (const PipePlan& pipe : plan.pipes) {
        PipeSettings settings = pipe.settings;
        settings.first = handles[pipe.first];
        if (pipe.second) settings.second = handles[*pipe.second];
        name_object(world, called_at(pipe.place, [&] { return Cavities(world).add(settings); }), pipe.name);
    }
    return handles;
}

}  // namespace skerry
