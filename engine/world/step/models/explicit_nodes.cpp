// Motion model of the nodes of explicit bodies, which have lumped masses. They are integrated explicitly, by symplectic
// Euler or leapfrog.
#include "engine/world/kernels.h"
#include "engine/world/step/seams.h"
#include "systems/dynamics/elements/find_unstrained.h"
#include "systems/dynamics/motion/advance_positions.h"
#include "systems/dynamics/motion/damp_velocity.h"
#include "systems/dynamics/motion/predict_velocity.h"

namespace skerry {

namespace {

void list_element_forces(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    ElementBlockTable& e = m.elements;
    BodyTable& b = m.bodies;
    const StepParameters& p = w.scratch.parameters;
    const auto if_unknown = only_if([](bool known) { return !known; }, value(p.forces_known));
    g.stage_with_result("dynamics/find_unstrained", w.scratch.findings.unstrained, find_unstrained,
                        inputs<UnstrainedInputs>(e, m.element_nodes, m.materials, b, n, m.any_idle),
                        outputs<UnstrainedOutputs>(b, e), if_unknown);
    g.stage_with_result("dynamics/compute_element_forces", w.scratch.findings.relaxed, kernels().compute_element_forces,
                        inputs<ElementInputs>(e, m.element_nodes, m.materials, b, m.any_idle), read(n.position),
                        read(n.velocity), value(p.kick_time), read(e.rotation), outputs<ElementMemory>(e),
                        outputs<PatchForces>(m.patches, m.element_nodes), if_unknown);
}

void list_prediction(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    BodyTable& b = m.bodies;
    NodeBlockTable& k = m.node_blocks;
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/predict_velocity", kernels().predict_velocity,
            inputs<KickInputs>(k, m.patches, n, b, p.gravity, m.forced, m.any_idle), read(n.velocity),
            value(p.kick_time), write(n.force), write(n.velocity_next));
    g.stage("dynamics/damp_velocity", kernels().damp_velocity,
            inputs<DampingInputs>(k, b, m.materials, n, p.lag, m.any_idle), read(n.velocity), value(p.kick_time),
            write(k.sums), write(n.velocity_next), make(w.scratch.findings.damped));
}

void list_inversions(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const bool& pushed = w.scratch.regions.pushed;
    g.stage_with_result("dynamics/find_inversions", w.scratch.findings.inversions, kernels().find_inversions,
                        inputs<InversionInputs>(m.tetrahedra, m.bodies, m.nodes, pushed), value(w.scratch.parameters.h),
                        make(w.scratch.inversions), outputs<InversionBudgets>(m.tetrahedra, m.bodies), if_possible(w));
}

void list_advance(WorldState& w, TaskGraph& g) {
    NodeTable& n = w.model.nodes;
    NodeBlockTable& k = w.model.node_blocks;
    g.stage("dynamics/advance_positions", kernels().advance_positions,
            inputs<AdvanceInputs>(k, w.model.bodies, n, n.velocity_next, w.model.any_asleep),
            value(w.scratch.parameters.h), outputs<AdvanceOutputs>(n, k, w.scratch.regions.pushed), if_taken(w));
}

}  // namespace

constinit const MotionModel explicit_nodes{
    .add_forces = list_element_forces, .predict = list_prediction, .check = list_inversions, .integrate = list_advance};

}  // namespace skerry
