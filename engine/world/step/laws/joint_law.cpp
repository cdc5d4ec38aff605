// Constraint law of joints between rigid bodies. Its rows are the equations, limits and motors of joints
// (docs/methods/joints.md).
#include "engine/world/step/seams.h"
#include "systems/dynamics/joints/measure_joints.h"
#include "systems/dynamics/joints/prepare_joints.h"

namespace skerry {

namespace {

void list_joint_rows(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("dynamics/prepare_joints", prepare_joints,
            inputs<JointInputs>(m.joints, m.bodies, m.rigid_bodies, m.any_asleep), value(w.clock.time),
            value(w.scratch.parameters.h), value(w.scratch.parameters.kick_time), make(w.scratch.joints));
}

void list_joint_measures(WorldState& w, TaskGraph& g) {
    g.stage_with_result("dynamics/measure_joints", w.scratch.findings.joints, measure_joints,
                        inputs<JointWorkInputs>(w.scratch.joints, w.model.rigid_bodies, w.model.bodies));
}

void list_joint_memory(WorldState& w, TaskGraph& g) {
    g.stage("dynamics/store_joints", store_joints, read(w.scratch.joints), value(w.scratch.parameters.kick_time),
            outputs<JointMemory>(w.model.joints), if_taken(w));
}

}  // namespace

constinit const ConstraintLaw joint_law{
    .find = list_joint_rows, .measure = list_joint_measures, .remember = list_joint_memory};

}  // namespace skerry
