// Force element for loads on single nodes (NodeTable::load). It must be the first entry of the list force_elements: its
// stage overwrites NodeTable::applied_force, and the stages of all other force elements add to this column.
#include "systems/forces/add_nodal_loads.h"

#include "engine/world/step/seams.h"

namespace skerry {

namespace {

bool any_load(const Model& model) {
    return model.loaded_bodies > 0;
}

void list_loads(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.model.nodes;
    const auto if_forced = only_if([](bool forced) { return forced; }, value(w.model.forced));
    g.stage("forces/add_nodal_loads", add_nodal_loads, read(n.load), write(n.applied_force), if_forced);
}

}  // namespace

constinit const ForceElement nodal_loads{.any = any_load, .add_forces = list_loads};

}  // namespace skerry
