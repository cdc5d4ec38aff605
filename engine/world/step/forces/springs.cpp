// Force element of springs and dampers (docs/methods/springs.md).
#include "systems/forces/springs.h"

#include "engine/world/step/seams.h"
#include "engine/world/step/weigh_springs.h"
#include "systems/dynamics/implicit/respond_at_anchors.h"

namespace skerry {

namespace {

bool any_spring(const Model& model) {
    return model.springs.size() > 0;
}

auto spring_inputs(const Model& m) {
    return inputs<SpringInputs>(m.springs, m.bodies, m.nodes, m.colliders, m.any_asleep);
}

auto if_any_spring(const Model& m) {
    return only_if([](std::span<const std::uint32_t> slot) { return !slot.empty(); }, read(m.springs.slot));
}

void list_spring_forces(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/respond_at_anchors", respond_at_anchors,
            inputs<ImplicitBodies>(m.rigid_bodies, m.bodies, m.materials, m.implicit_nodes, m.nodes, m.attachments,
                                   m.any_asleep),
            inputs<DampedAnchors>(m.springs, m.bodies), inputs<ImplicitTimes>(p.h, p.theta, p.long_step),
            make(m.stiff_bodies), outputs<AnchorResponses>(m.springs), if_any_spring(m));
    g.stage("forces/add_spring_forces", add_spring_forces, spring_inputs(m),
            inputs<SpringMasses>(m.springs, m.bodies, m.rigid_bodies), value(w.clock.time), value(p.h),
            value(p.kick_time), write(m.springs.next), write(m.nodes.applied_force), if_any_spring(m));
}

void list_driven_springs(WorldState& w, TaskGraph& g) {
    g.stage("forces/mark_driven_bodies", mark_driven_bodies, spring_inputs(w.model), value(w.clock.time),
            value(w.scratch.parameters.h), write(w.scratch.driven), if_sleepy(w));
}

bool a_spring_is_driven(const Model& model, Real t, Real h) {
    const SpringInputs springs = springs_of(model);
    for (std::size_t s = 0; s < springs.size(); ++s)
        if (springs.is_driven(s, t, h)) return true;
    return false;
}

void list_spring_measures(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("forces/measure_springs", w.scratch.findings.springs, measure_springs, spring_inputs(m),
                        inputs<SpringWorkInputs>(m.springs, m.nodes, m.bodies, m.rigid_bodies), value(p.h),
                        value(p.kick_time), value(p.work_lag), if_any_spring(m));
}

void list_spring_memory(WorldState& w, TaskGraph& g) {
    SpringTable& springs = w.model.springs;
    g.stage("forces/keep_spring_forces", keep_spring_forces, read(springs.next), outputs<SpringMemory>(springs),
            if_taken(w));
}

Real energy_of_springs(const Model& model, Real t, Real lag) {
    return spring_energy(springs_of(model),
                         SpringWorkInputs::bind({}, model.springs, model.nodes, model.bodies, model.rigid_bodies), t,
                         lag);
}

}  // namespace

constinit const ForceElement spring_forces{.any = any_spring,
                                           .add_forces = list_spring_forces,
                                           .derive = weigh_springs,
                                           .add_rate = add_spring_rates,
                                           .rate_moves = true,
                                           .bound_damping = bound_spring_damping,
                                           .mark_driven = list_driven_springs,
                                           .is_driven = a_spring_is_driven,
                                           .measure = list_spring_measures,
                                           .remember = list_spring_memory,
                                           .energy = energy_of_springs};

}  // namespace skerry
