// Motion model of rigid bodies, and of the frames of implicit bodies (docs/methods/rigid_bodies.md).
#include "engine/world/step/seams.h"
#include "systems/dynamics/rigid/move_rigid_bodies.h"

namespace skerry {

namespace {

auto rigid_inputs(const Model& m) {
    return inputs<RigidBodies>(m.rigid_bodies, m.bodies, m.nodes, m.any_asleep, m.forced);
}

void list_rigid_kick(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    const StepParameters& p = w.scratch.parameters;
    g.stage("dynamics/kick_rigid_bodies", kick_rigid_bodies, rigid_inputs(m),
            inputs<RigidHolds>(m.rigid_bodies, m.attachments), inputs<RigidForces>(m.nodes, p.gravity, m.forced),
            value(p.h), value(p.kick_time), outputs<RigidKicks>(m.rigid_bodies, m.nodes));
}

/// Lists the stage that computes the pose of each body at the end of the step. The stage also sets velocity_next of
/// each node to the constant velocity that takes the node to its position at the end of the step.
void list_turn(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    g.stage("dynamics/turn_rigid_bodies", turn_rigid_bodies, rigid_inputs(m),
            inputs<RigidHolds>(m.rigid_bodies, m.attachments), inputs<RigidImpulses>(m.rigid_bodies),
            inputs<ElasticMotion>(m.implicit_nodes, m.rigid_bodies), read(m.nodes.position),
            value(w.scratch.parameters.h), outputs<RigidTurns>(m.rigid_bodies, m.nodes));
}

void list_rigid_move(WorldState& w, TaskGraph& g) {
    Model& m = w.model;
    RigidBodyTable& r = m.rigid_bodies;
    g.stage("dynamics/move_rigid_bodies", move_rigid_bodies, rigid_inputs(m), inputs<RigidImpulses>(r),
            inputs<ElasticMotion>(m.implicit_nodes, r), read(r.center_next), read(r.rotation_next),
            value(w.scratch.parameters.draws_late), outputs<RigidMoves>(r, m.nodes, m.implicit_nodes), if_taken(w));
}

}  // namespace

constinit const MotionModel rigid_bodies{
    .predict = list_rigid_kick, .find_pose = list_turn, .integrate = list_rigid_move};

}  // namespace skerry
