// What loads and held nodes gave to the moving nodes in this step, for the balance of a run.
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
    std::span<const Vec3> load;   // N, by node; empty: none
    std::span<const Vec3> force;  // N, by node without freedom
    std::span<const Vec3> velocity_next;
    std::span<const Real> mass;   // kg, by node
    std::span<const Index> held;  // nodes
    std::span<const Index> node_body;
    std::span<const Range> body_implicit;  // BodyTable; of those with rows forces are those of the step already
    RestingNodes resting;
    Vec3 gravity = Vec3::Zero();  // m/s^2

    /// `loaded`: some node has a load. `any_asleep`: some body rests.
    static WorkInputs bind(const Binder& binder, const NodeTable& node, const AttachmentTable& attachment,
                           const BodyTable& body, const bool& loaded, const bool& any_asleep, const Vec3& gravity) {
        return {.load = binder.read_if(binder.value(loaded), node.load),
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

/// Loads on all nodes and the forces that hold the nodes `held`, which are the opposite of `force` there: impulse kick
/// F and, of loads, which are constant, work h F . velocity_next, the displacement of a symplectic step. What holds
/// nodes works against their weight and loads by as much, and against elements for as long as these act. Nodes at rest
/// do not count: what holds them is not known. The loads' sum goes over fixed blocks, in their order.
ExternalWork measure_work(Executor& executor, const WorkInputs& nodes, Real h, Real kick,
                          Column<ExternalWork>& partial);

}  // namespace skerry
