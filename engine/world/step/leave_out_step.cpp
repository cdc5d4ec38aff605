// Finds steps in which all bodies sleep and nothing moves. They are skipped, because no stage would change anything
// (docs/methods/skipping.md 3.2).
#include <algorithm>

#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"
#include "systems/dynamics/joints/prepare_joints.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

namespace {

bool all_bodies_rest(const BodyTable& bodies) {
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) {
        if (bodies.kind[b] == BodyKind::deformable && !bodies.asleep[b]) return false;
        // A body that has just fallen asleep still has the speed of its last step. One more step must run its stages,
        // which set this speed to zero.
        if (bodies.max_speed[b] != 0) return false;
    }
    return true;
}

/// Computes the motion of all rows of `table` in this step. The table contains colliders or attachments. Returns true
/// if none of them moves.
bool all_stand_still(auto& table, Real time, Real h) {
    move_colliders(ColliderMotionInputs::bind({}, table), time, h, table.motion);
    return std::ranges::all_of(table.motion, [](const RigidMotion& motion) { return motion.stands_still(); });
}

bool a_motor_moves(const Model& model, Real time, Real h) {
    const JointInputs joints = JointInputs::bind({}, model.joints, model.bodies, model.rigid_bodies, model.any_asleep);
    for (std::size_t j = 0; j < joints.size(); ++j)
        if (joints.target_moves(j, time, h)) return true;
    return false;
}

bool a_force_changes(const Model& model, Real time, Real h) {
    return std::ranges::any_of(force_elements, [&](const ForceElement* element) {
        return element->is_driven && element->any(model) && element->is_driven(model, time, h);
    });
}

/// True if the stable step of a shape that store_shapes has copied is still to be evaluated. A stage does this, so the
/// next step must not be skipped. This can happen although all bodies sleep, because a body may fall asleep after its
/// shape was copied.
bool checks_are_due(const StepWatch& watch) {
    for (Index b = watch.body; b < watch.kept; ++b)
        if (watch.step[static_cast<std::size_t>(b)] != StepWatch::not_evaluated) return true;
    return false;
}

}  // namespace

bool nothing_moves(WorldState& world) {
    Model& model = world.model;
    const StepScratch& scratch = world.scratch;
    const Real time = world.clock.time, h = scratch.parameters.h;
    if (!model.any_asleep || !model.tuning.contact_budgets || !all_bodies_rest(model.bodies)) return false;
    if (scratch.contacts.size() > 0 || scratch.regions.size() > 0 || scratch.regions.pushed) return false;
    if (!world.cache.crossings.row.empty() || checks_are_due(model.watch)) return false;
    if (a_motor_moves(model, time, h) || a_force_changes(model, time, h)) return false;
    if (!all_stand_still(model.colliders, time, h) || !all_stand_still(model.attachments, time, h)) return false;
    drive_nodes(NodeMotionInputs::bind({}, model.attachments), h, model.nodes.position, model.nodes.velocity);
    return true;
}

void forget_forces_of_step(const Model& model, ForceScratch& forces) {
    forces.pairs.clear();
    forces.reactions.assign(model.attachments.slot.size(), {});
}

void check_balance_after_motion(WorldState& world) {
    Balance& balance = world.record.balance;
    // nothing has moved since the last check, so the balance is unchanged
    if (balance.open && world.scratch.skipped && world.record.balance_of_rest) return;
    join_records(world);
    check_balance(world, world.clock.time, lag_between_steps(world), balance);
    world.record.balance_of_rest = world.scratch.skipped;
}

}  // namespace skerry
