// Measures the impulse and work of loads and of holding forces in a step, for the balances of energy and momentum.
#pragma once

#include <span>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/column.h"
#include "components/external_work.h"
#include "components/free_nodes.h"
#include "components/ghost_marks.h"
#include "components/node_table.h"
#include "components/resting_nodes.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct WorkInputs {
    std::span<const Vec3> load;         // applied force by node; empty if there are no applied forces [N]
    std::span<const Vec3> load_before;  // applied force of the last step by node; empty if there were none [N]
    std::span<const Vec3> force;        // force of elements, weight and loads by node; used only at held nodes [N]
    std::span<const Vec3> velocity, velocity_next;  // [m/s]
    FreeNodes free;
    std::span<const Real> mass;   // kg, by node
    std::span<const Index> held;  // nodes of all attachments; read only to test whether there are any
    std::span<const Index> node_body;
    std::span<const Range> body_implicit;  // ImplicitNodeTable rows by body; empty if the body is not implicit
    RestingNodes resting;
    GhostMarks ghosts;
    Vec3 gravity = Vec3::Zero();  // m/s^2

    /// `forced`: true if the world has force elements. `any_asleep`: true if at least one body is asleep.
    static WorkInputs bind(const Binder& binder, const NodeTable& node, const AttachmentTable& attachment,
                           const BodyTable& body, const RigidBodyTable& rigid, const bool& forced,
                           const bool& any_asleep, const Vec3& gravity) {
        return {.load = binder.read_if(binder.value(forced), node.applied_force),
                .load_before = binder.read_if(binder.value(forced), node.applied_before),
                .force = binder.read(node.force),
                .velocity = binder.read(node.velocity),
                .velocity_next = binder.read(node.velocity_next),
                .free = FreeNodes::bind(binder, node, body, rigid),
                .mass = binder.read(node.mass),
                .held = binder.read(attachment.node),
                .node_body = binder.read(node.body),
                .body_implicit = binder.read(body.implicit),
                .resting = {.node_body = binder.read_if(binder.value(any_asleep), node.body),
                            .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep)},
                .ghosts = {binder.read(body.ghost)},
                .gravity = binder.value(gravity)};
    }
};

/// Sums impulse and work of the loads on all nodes, and of the forces that hold nodes with inverse mass 0. A holding
/// force is the opposite of `force`. Sums run over fixed groups of nodes, in a fixed order. Two kinds of nodes do not
/// count:
/// - nodes of sleeping bodies, because the forces that hold them are unknown;
/// - ghosts (copies of bodies of other ranks), because their owners count them.
///
/// Three times occur [s]: the step length `h`, the force interval `kick` (time for which forces act), and `lag`, which
/// is half of the length of the previous step, or 0 with leapfrog. For a force F on a node:
/// - The impulse is kick F.
/// - A load does the work F . (displacement in the step). The displacement is h velocity_next in symplectic Euler. With
///   leapfrog the displacement of a free node is h (velocity + velocity_next) / 2.
/// - A load on a free node that has changed by dF since the last step does the additional work lag dF . velocity,
///   because each load acts over half of the previous step and half of this step.
/// - A holding force does work over h with the part that balances weight and loads, and over `kick` with the part that
///   balances element forces. For an implicit body both times are `kick`, because strain_implicit_bodies has scaled
///   `force` to this time.
ExternalWork measure_work(Executor& executor, const WorkInputs& nodes, Real h, Real kick, Real lag,
                          Column<ExternalWork>& partial);

}  // namespace skerry
