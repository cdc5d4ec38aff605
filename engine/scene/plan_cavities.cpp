// Finds the bodies and cavities that the entries of cavities and pipes name, and adds cavities and pipes to a world.
#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

CavityPlan plan_cavity(const CavityEntry& entry, const ScenePlan& plan) {
    CavityPlan cavity;
    cavity.place = entry.place;
    cavity.name = choose_name(entry.name, names_of(plan.cavities), "cavity", entry.place);
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
    const std::vector<std::string_view> cavities = names_of(plan.cavities);
    pipe.first = find_name(cavities, entry.first, "cavity", entry.place.key("first"));
    if (entry.second) pipe.second = find_name(cavities, *entry.second, "cavity", entry.place.key("second"));
    pipe.settings.conductance = entry.conductance;
    if (entry.pressure) pipe.settings.pressure = *entry.pressure;
    return pipe;
}

}  // namespace

void plan_cavities(const SceneFile& scene, ScenePlan& plan) {
    for (const CavityEntry& cavity : scene.cavities) plan.cavities.push_back(plan_cavity(cavity, plan));
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
