// Motion model of the deformation of implicit bodies. The deformation is relative to a frame that moves like a rigid
// body (docs/methods/implicit_bodies.md).
#include "engine/world/step/seams.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"

namespace skerry {

namespace {

auto implicit_inputs(const Model& m) {
    return inputs<ImplicitBodies>(m.rigid_bodies, m.bodies, m.materials, m.implicit_nodes, m.nodes, m.attachments,
                                  m.any_asleep);
}
auto implicit_times(const StepParameters& p) {
    return inputs<ImplicitTimes>(p.h, p.theta, p.long_step);
}

void list_implicit_kick(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/kick_implicit_bodies", kick_implicit_bodies, implicit_inputs(m),
            inputs<ImplicitLoads>(m.nodes, p.gravity, m.forced, p.kick_time), inputs<ImplicitSpins>(m.rigid_bodies),
            implicit_times(p), make(m.stiff_bodies), outputs<ImplicitKicks>(m.implicit_nodes, m.nodes));
}

void list_coupling(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("dynamics/couple_implicit_bodies", couple_implicit_bodies, implicit_inputs(m),
            inputs<TouchedNodes>(w.scratch.contacts, w.scratch.cables), read(m.nodes.body),
            implicit_times(w.scratch.parameters), make(m.stiff_bodies), make(w.scratch.coupling));
}

/// Lists the stage that computes the deformation of implicit bodies at the end of the step, and the forces on their
/// held nodes.
void list_strain(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage_with_result("dynamics/strain_implicit_bodies", w.scratch.findings.strained, strain_implicit_bodies,
                        implicit_inputs(m), inputs<ImplicitLoads>(m.nodes, p.gravity, m.forced, p.kick_time),
                        inputs<ImplicitSpins>(m.rigid_bodies), implicit_times(p), make(m.stiff_bodies),
                        outputs<ImplicitStrains>(m.implicit_nodes, m.rigid_bodies, m.nodes),
                        make(w.scratch.strain_parts));
}

void list_long_steps(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    const auto if_long = only_if([](bool takes) { return takes; }, value(p.takes_long_steps));
    g.stage("dynamics/carry_long_steps", carry_long_steps, implicit_times(p), read(m.rigid_bodies.body),
            read(m.bodies.implicit), make(m.stiff_bodies), write(m.implicit_nodes.left), if_taken(w), if_long);
}

}  // namespace

constinit const MotionModel implicit_bodies{
    .predict = list_implicit_kick, .couple = list_coupling, .apply = list_strain, .integrate = list_long_steps};

}  // namespace skerry
