// Impulse and work of loads and held nodes on the moving nodes in this step, for the balance of a run.
#pragma once

#include <span>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/column.h"
#include "components/node_table.h"
#include "components/resting_nodes.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct ExternalWork {
    Vec3 impulse = Vec3::Zero();  // N s
    Real work = 0;                // J
};

struct WorkInputs {
    std::span<const Vec3> load;   // applied force by node; empty: none [N]
    std::span<const Vec3> force;  // by held node [N]
    std::span<const Vec3> velocity_next;
    std::span<const Real> mass;   // kg, by node
    std::span<const Index> held;  // nodes
    std::span<const Index> node_body;
    std::span<const Range> body_implicit;  // BodyTable; with rows: `force` is already that of the whole step
    RestingNodes resting;
    Vec3 gravity = Vec3::Zero();  // m/s^2

    /// `forced`: true if the world has force elements. `any_asleep`: true if some body is asleep.
    static WorkInputs bind(const Binder& binder, const NodeTable& node, const AttachmentTable& attachment,
                           const BodyTable& body, const bool& forced, const bool& any_asleep, const Vec3& gravity) {
        return {.load = binder.read_if(binder.value(forced), node.applied_force),
                .force = binder.read(node.force),
                .velocity_next = binder.read(node.velocity_next),
                .mass = binder.read(node.mass),
                .held = binder.read(attachment.node),
                .node_body = binder.read(node.body),
                .body_implicit = binder.read(body.implicit),
                .resting = {.node_body = binder.read_if(binder.value(any_asleep), node.body),
                            .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep)},
                .gravity = binder.value(gravity)};
    }
};

/// Impulse and work of the loads on all nodes and of the forces that hold the nodes `held`, the opposite of `force`
/// there. The impulse is kick F. Loads are constant and do the work h F . velocity_next, since h velocity_next is the
/// displacement of a symplectic step. Holding forces do work against weight and loads for h, too, but against elements
/// for `kick`. Nodes at rest do not count: the force that holds them is unknown. Loads are summed over fixed blocks, in
/// their order.
ExternalWork measure_work(Executor& executor, const WorkInputs& nodes, Real h, Real kick,
                          Column<ExternalWork>& partial);

}  // namespace skerry
