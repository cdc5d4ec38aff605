// The drifts of leapfrog, which change positions but not velocities (docs/methods/time_stepping.md 1.2). Within a call
// of advance(), positions lead by half a step, so that each step changes velocities in its middle:
// - The first drift of a call produces this lead.
// - If the step length changes, a drift before the step changes the lead to half of the new step.
// - The last drift takes the lead back, so that positions and velocities belong to the same time.
#include <algorithm>

#include "engine/world/step/step.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/motion/advance_positions.h"
#include "systems/dynamics/motion/measure_displacement.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/dynamics/rigid/move_rigid_bodies.h"

namespace skerry {

namespace {

void measure_displacement_of(Executor& executor, Model& model, Real seconds, SearchMemory& search) {
    NodeTable& n = model.nodes;
    NodeBlockTable& k = model.node_blocks;
    BodyTable& b = model.bodies;
    measure_displacement(executor, DisplacementInputs::bind({}, k, b, n), seconds,
                         DisplacementOutputs::bind({}, n, search.rebase, b));
}

void forget_impulses(RigidBodyTable& rigid) {
    for (Column<Vec3>* column : {&rigid.kick, &rigid.moment_kick, &rigid.contact_impulse, &rigid.contact_moment,
                                 &rigid.push_velocity, &rigid.push_spin})
        std::ranges::fill(*column, Vec3::Zero());
}

}  // namespace

void drift_to(Executor& executor, Real offset, Model& model, Clock& clock, SearchMemory& search) {
    const Real seconds = offset - clock.offset;
    if (seconds == 0) return;
    NodeTable& n = model.nodes;
    NodeBlockTable& k = model.node_blocks;
    AttachmentTable& a = model.attachments;
    ColliderTable& c = model.colliders;
    move_colliders(ColliderMotionInputs::bind({}, c), clock.time, seconds, c.motion);
    move_colliders(ColliderMotionInputs::bind({}, a), clock.time, seconds, a.motion);
    drive_nodes(NodeMotionInputs::bind({}, a), seconds, n.position, n.velocity);
    const bool pushed = false;  // no contact pushes bodies out of overlaps in a drift
    RigidBodyTable& r = model.rigid_bodies;
    ImplicitNodeTable& i = model.implicit_nodes;
    forget_impulses(r);
    drift_implicit_bodies(ImplicitBodies::bind({}, r, model.bodies, model.materials, i, n, a, model.any_asleep),
                          ImplicitSpins::bind({}, r), model.stiff_bodies, seconds, ImplicitStrains::bind({}, i, r, n));
    turn_rigid_bodies(executor, RigidBodies::bind({}, r, model.bodies, n, model.any_asleep, model.forced),
                      RigidHolds::bind({}, r, a), RigidImpulses::bind({}, r), ElasticMotion::bind({}, i, r), n.position,
                      seconds, {r.center_next, r.rotation_next, n.velocity});
    advance_positions(executor, AdvanceInputs::bind({}, k, model.bodies, n, n.velocity, model.any_asleep), seconds,
                      AdvanceOutputs::bind({}, n, k, pushed));
    move_rigid_bodies(executor, RigidBodies::bind({}, r, model.bodies, n, model.any_asleep, model.forced),
                      RigidImpulses::bind({}, r), ElasticMotion::bind({}, i, r), r.center_next, r.rotation_next, false,
                      RigidMoves::bind({}, r, n, i));
    measure_displacement_of(executor, model, seconds, search);
    add_collider_travel(std::abs(seconds), search.collider_extent, c);
    clock.time += seconds;
    clock.offset = offset;
}

void measure_displacement_again(Executor& executor, Model& model, SearchMemory& search) {
    const NodeTable& n = model.nodes;
    NodeBlockTable& k = model.node_blocks;
    for (std::size_t b = 0; b < k.begin.size(); ++b) {
        const auto first = static_cast<std::size_t>(k.begin[b]), count = static_cast<std::size_t>(k.end[b]) - first;
        k.displacement_squared[b] = block_displacement_squared(
            n.position.span().subspan(first, count), n.displacement_origin.span().subspan(first, count),
            model.bodies.frame[static_cast<std::size_t>(k.body[b])].offset);
    }
    measure_displacement_of(executor, model, 0, search);  // 0 s: MovingFrame::offset of the bodies stays unchanged
}

void add_collider_travel(Real seconds, std::span<const Real> extent, ColliderTable& colliders) {
    for (std::size_t c = 0; c < colliders.slot.size(); ++c) {
        const RigidMotion& motion = colliders.motion[c];
        // The speed of a point of a rotating collider grows with its distance from the axis. Only points near a body
        // matter. According to the contact search, they are at most `extent` away from the origin of the collider.
        const Real turning = motion.angular_velocity.norm();
        const Real rim_speed = turning > 0 && c < extent.size() ? turning * extent[c] : 0;
        colliders.travel[c] += seconds * (motion.velocity.norm() + rim_speed);
    }
}

}  // namespace skerry
