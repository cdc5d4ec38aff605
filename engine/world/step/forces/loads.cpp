// Force element for loads and force fields (LoadTable). nodal_loads.cpp adds the loads of single nodes
// (NodeTable::load).
#include <algorithm>

#include "engine/world/step/seams.h"
#include "systems/forces/add_loads.h"
#include "systems/forces/drag_couples.h"

namespace skerry {

namespace {

bool any_of_loads(const Model& model) {
    return model.loads.size() > 0;
}

void add_load_stages(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    StepScratch& s = w.scratch;
    const StepParameters& p = s.parameters;
    const auto if_any = only_if([](std::span<const Index> body) { return !body.empty(); }, read(m.loads.body));
    g.stage("forces/add_loads", add_loads, inputs<LoadInputs>(m.loads, m.bodies, m.nodes, p.gravity, p.intervals),
            make(s.fields), write(m.nodes.applied_force), if_any);
    const auto if_drag =
        only_if([](std::span<const LoadKind> kind) { return std::ranges::find(kind, LoadKind::drag) != kind.end(); },
                read(m.loads.kind));
    g.stage("forces/add_drag_couples", add_drag_couples, inputs<DraggedBodies>(m.rigid_bodies, m.bodies, m.nodes),
            read(s.fields), write(m.nodes.applied_force), if_drag);
}

void list_driven_loads(WorldState& w, TaskGraph& g) {
    g.stage("forces/mark_loaded", mark_loaded, inputs<LoadedBodies>(w.model.loads, w.model.bodies), value(w.clock.time),
            value(w.scratch.parameters.h), write(w.scratch.driven), if_sleepy(w));
}

LoadInputs loads_of(const Model& model) {
    return LoadInputs::bind({}, model.loads, model.bodies, model.nodes, model.settings.gravity, {});
}

void add_traction_rates(Model& model, std::span<Real> of_body) {
    const LoadInputs loads = loads_of(model);
    for (std::size_t load = 0; load < model.loads.size(); ++load) {
        if (!loads.is_on_present_area(load)) continue;
        if (const auto body = static_cast<std::size_t>(loads.load_body[load]); !model.has_frame(body))
            of_body[body] += traction_rate(loads, load, model.nodes.inverse_mass);
    }
}

void add_drag_rates(const Model& model, std::span<Real> of_body) {
    const LoadInputs loads = loads_of(model);
    for (std::size_t load = 0; load < model.loads.size(); ++load)
        for (std::size_t body = 0; body < of_body.size() && loads.kind[load] == LoadKind::drag; ++body)
            if (loads.acts_on(load, body)) of_body[body] += loads.rate[load];
}

bool a_load_changes(const Model& model, Real t, Real h) {
    for (std::size_t row = 0; row < model.loads.size(); ++row)
        if (changes(model.loads.keys_of(row), t, h)) return true;
    return false;
}

}  // namespace

constinit const ForceElement loads_and_fields{.any = any_of_loads,
                                              .add_forces = add_load_stages,
                                              .add_rate = add_traction_rates,
                                              .rate_moves = true,
                                              .add_drag = add_drag_rates,
                                              .mark_driven = list_driven_loads,
                                              .is_driven = a_load_changes};

}  // namespace skerry
