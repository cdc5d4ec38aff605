// Force element of cables. It lists the cables that act in the step, and adds the forces of frictionless cables with a
// prescribed tension. All other cables become rows of the contact problem (laws/cable_law.cpp, docs/methods/cables.md).
#include "engine/world/step/seams.h"
#include "systems/forces/prepare_cables.h"

namespace skerry {

namespace {

bool any_cable(const Model& model) {
    return model.cables.size() > 0;
}

void list_cables(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage("forces/prepare_cables", prepare_cables,
            inputs<CableInputs>(m.cables, m.bodies, m.nodes, m.colliders, m.any_asleep),
            inputs<CableTimes>(w.clock.time, p.h, p.kick_time, p.solver.recovery_speed), make(w.scratch.cables));
    const auto if_forced = only_if([](bool forced) { return forced; }, value(m.forced));
    g.stage("forces/add_cable_forces", add_cable_forces, read(w.scratch.cables), value(p.kick_time),
            write(m.nodes.applied_force), if_forced);
}

void add_cable_rate(Model& model, std::span<Real> of_body) {
    add_cable_rates(CableInputs::bind({}, model.cables, model.bodies, model.nodes, model.colliders, model.any_asleep),
                    of_body);
}

void list_driven_cables(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("forces/mark_driven_cables", mark_driven_cables,
            inputs<CableInputs>(m.cables, m.bodies, m.nodes, m.colliders, m.any_asleep), value(w.clock.time),
            value(w.scratch.parameters.h), write(w.scratch.driven), if_sleepy(w));
}

bool a_cable_is_driven(const Model& model, Real t, Real h) {
    const CableInputs cables =
        CableInputs::bind({}, model.cables, model.bodies, model.nodes, model.colliders, model.any_asleep);
    for (std::size_t c = 0; c < cables.size(); ++c)
        if (cables.is_driven(c, t, h)) return true;
    return false;
}

}  // namespace

constinit const ForceElement cable_forces{.any = any_cable,
                                          .add_forces = list_cables,
                                          .add_rate = add_cable_rate,
                                          .rate_moves = true,
                                          .mark_driven = list_driven_cables,
                                          .is_driven = a_cable_is_driven};

}  // namespace skerry
