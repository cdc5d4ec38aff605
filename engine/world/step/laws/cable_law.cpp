// Constraint law of cables with a prescribed length, or with friction at the points over which they run
// (docs/methods/cables.md). The rows of these cables are prepared by the stage forces/prepare_cables
// (forces/cables.cpp), so this law has no `find`.
#include "engine/world/step/seams.h"
#include "systems/forces/prepare_cables.h"

namespace skerry {

namespace {

void list_cable_measures(WorldState& w, TaskGraph& g) {
    g.stage_with_result("forces/measure_cables", w.scratch.findings.cables, measure_cables, read(w.scratch.cables),
                        read(w.model.nodes.body), read(w.model.bodies.ghost));
}

void list_cable_memory(WorldState& w, TaskGraph& g) {
    const StepParameters& p = w.scratch.parameters;
    g.stage("forces/store_cables", store_cables, read(w.scratch.cables),
            inputs<CableTimes>(w.clock.time, p.h, p.kick_time, p.solver.recovery_speed),
            outputs<CableMemory>(w.model.cables), if_taken(w));
}

}  // namespace

constinit const ConstraintLaw cable_law{.measure = list_cable_measures, .remember = list_cable_memory};

}  // namespace skerry
