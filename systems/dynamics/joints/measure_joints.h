// Impulse and work of joints on the bodies that they move in this step, for the energy and momentum balance of a run.
#pragma once

#include <span>

#include "components/ghost_marks.h"
#include "components/joint_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"

namespace skerry {

struct JointMeasures {
    Vec3 impulse = Vec3::Zero();  // impulse that joints transmit from the world and from held bodies [N s]
    Real work = 0;  // work of all joint impulses: motors, springs, dampers, friction, stops, held bodies [J]
};

/// Joint blocks by row of JointBlockTable, and columns of RigidBodyTable, after the contact solve.
struct JointWorkInputs {
    std::span<const JointBlock> block;
    std::span<const Vec3> impulse;  // by joint block
    std::span<const Real> mass;
    std::span<const Vec3> center, momentum, angular_momentum;
    std::span<const Mat3> inverse_inertia;
    std::span<const Vec3> kick, moment_kick, contact_impulse, contact_moment;
    std::span<const Index> body;  // row of BodyTable
    GhostMarks ghosts;

    static JointWorkInputs bind(const Binder& binder, const JointBlockTable& blocks, const RigidBodyTable& rigid,
                                const BodyTable& bodies) {
        return {.block = binder.read(blocks.block),
                .impulse = binder.read(blocks.impulse),
                .mass = binder.read(rigid.mass),
                .center = binder.read(rigid.center),
                .momentum = binder.read(rigid.momentum),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .inverse_inertia = binder.read(rigid.inverse_inertia),
                .kick = binder.read(rigid.kick),
                .moment_kick = binder.read(rigid.moment_kick),
                .contact_impulse = binder.read(rigid.contact_impulse),
                .contact_moment = binder.read(rigid.contact_moment),
                .body = binder.read(rigid.body),
                .ghosts = {binder.read(bodies.ghost)}};
    }
};

/// Sums the work of joints, and the impulses that joints transmit from the world and from held bodies. A joint that
/// moves a ghost (copy of a body of another rank) does not count, because the owner of the ghost counts it. Sequential,
/// in block order.
JointMeasures measure_joints(const JointWorkInputs& joints);

}  // namespace skerry
