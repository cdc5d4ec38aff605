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
    std::span<const Index> held;  // nodes
    RestingNodes resting;

    /// `loaded`: some node has a load. `any_asleep`: some body rests.
    static WorkInputs bind(const Binder& binder, const NodeTable& node, const AttachmentTable& attachment,
                           const BodyTable& body, const bool& loaded, const bool& any_asleep) {
        return {.load = binder.read_if(binder.value(loaded), node.load),
                .force = binder.read(node.force),
                .velocity_next = binder.read(node.velocity_next),
                .held = binder.read(attachment.node),
                .resting = {.node_body = binder.read_if(binder.value(any_asleep), node.body),
                            .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep)}};
    }
};

/// Loads on all nodes and the forces that hold the nodes `held`, which are the opposite of `force` there: impulse h F
/// and work h F . velocity_next, the displacement of a symplectic step. Nodes at rest do not count: what holds them is
/// not known. The loads' sum goes over fixed blocks, in their order.
ExternalWork measure_work(Executor& executor, const WorkInputs& nodes, Real h, Column<ExternalWork>& partial);

}  // namespace skerry
