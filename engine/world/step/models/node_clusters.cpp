// Motion model of clusters. A cluster consists of the moving nodes of connected elements that would be unstable with
// explicit integration at the chosen step length. An implicit method integrates these nodes together
// (docs/methods/clusters.md).
#include "engine/world/kernels.h"
#include "engine/world/step/seams.h"
#include "systems/dynamics/clusters/stiffen_clusters.h"

namespace skerry {

namespace {

void list_stiffening(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    ElementBlockTable& e = m.elements;
    const StepParameters& p = w.scratch.parameters;
    const auto if_unknown = only_if([](bool known) { return !known; }, value(p.forces_known));
    g.stage_with_result("dynamics/stiffen_clusters", w.scratch.findings.stiffened, stiffen_clusters,
                        inputs<ElementInputs>(e, m.element_nodes, m.materials),
                        inputs<StiffenInputs>(m.bodies, m.nodes), value(p.kick_time),
                        outputs<PatchForces>(m.patches, m.element_nodes), outputs<StiffenOutputs>(e, m.clusters),
                        if_unknown);
}

void list_cluster_kick(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    g.stage("dynamics/kick_clusters", kernels().kick_clusters,
            inputs<ClusterKickInputs>(m.clusters, n, m.bodies, m.any_asleep), read(n.velocity),
            value(w.scratch.parameters.forces_known), make(w.scratch.cluster_kick), make(w.scratch.cluster_work),
            write(n.velocity_next));
}

void list_viscosity(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    NodeTable& n = m.nodes;
    const auto if_viscous = only_if([](std::span<const ElementViscousImpulse> impulse) { return !impulse.empty(); },
                                    read(m.patches.viscous_impulse));
    g.stage_with_result("dynamics/measure_viscosity", w.scratch.findings.viscous, kernels().measure_viscosity,
                        inputs<ElementInputs>(m.elements, m.element_nodes, m.materials, m.bodies, m.any_idle),
                        read(m.patches.blocks), read(m.patches.viscous_impulse), read(m.patches.viscous),
                        read(n.velocity), read(n.velocity_next), make(w.scratch.viscous_parts), if_viscous);
}

}  // namespace

constinit const MotionModel node_clusters{
    .add_forces = list_stiffening, .predict = list_cluster_kick, .check = list_viscosity};

}  // namespace skerry
