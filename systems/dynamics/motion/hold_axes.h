// Holds nodes along single directions, as roller supports do.
#pragma once

#include <span>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/cable_table.h"
#include "components/column.h"
#include "components/contact_table.h"
#include "components/external_work.h"
#include "components/ghost_marks.h"
#include "components/node_table.h"
#include "components/resting_nodes.h"
#include "jobs/access.h"

namespace skerry {

struct AxisHoldInputs {
    // by row of AttachmentTable
    std::span<const Mat3> held;
    std::span<const RigidMotion> motion;
    std::span<const Range> nodes;  // range of entries in `node` and `anchor`
    std::span<const Index> node;   // rows of NodeTable
    std::span<const Vec3> anchor;  // position in the frame of the attachment [m]
    // by node
    std::span<const Vec3> position, velocity;  // state at the start of the step
    std::span<const Vec3> load;                // applied force; empty if there are none [N]
    std::span<const Real> mass, inverse_mass;
    std::span<const Index> body;  // row of BodyTable
    RestingNodes resting;
    GhostMarks ghosts;
    Vec3 gravity = Vec3::Zero();  // m/s^2

    static AxisHoldInputs bind(const Binder& binder, const AttachmentTable& attachment, const NodeTable& node,
                               const BodyTable& body, const bool& forced, const bool& any_asleep, const Vec3& gravity) {
        return {.held = binder.read(attachment.held),
                .motion = binder.read(attachment.motion),
                .nodes = binder.read(attachment.nodes),
                .node = binder.read(attachment.node),
                .anchor = binder.read(attachment.anchor),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .load = binder.read_if(binder.value(forced), node.applied_force),
                .mass = binder.read(node.mass),
                .inverse_mass = binder.read(node.inverse_mass),
                .body = binder.read(node.body),
                .resting = {.node_body = binder.read_if(binder.value(any_asleep), node.body),
                            .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep)},
                .ghosts = {binder.read(body.ghost)},
                .gravity = binder.value(gravity)};
    }
};

/// Gives nodes that are held along single directions the prescribed velocities along these directions. At the end of
/// the step such a node is at the position that the pose of its attachment gives it, as in drive_nodes. Nodes of
/// sleeping bodies are left out. Sequential.
///
/// `held_impulse`: impulses by entry of AttachmentTable::node, zero for nodes that are held completely [N s]. Returns
/// the sum and the work of these impulses, without those on ghosts (copies of bodies of other ranks). The work is
/// measured as in measure_work, which explains `h`, `kick` and `lag`.
ExternalWork hold_axes(const AxisHoldInputs& inputs, Real h, Real kick, Real lag, std::span<Vec3> velocity_next,
                       Column<Vec3>& held_impulse);

/// Rows of the contact problem that hold nodes along single directions. While the contact regions are solved, they are
/// the last rows of ContactTable.
struct HeldRows {
    struct Node {
        Mat3 held = Mat3::Zero();     // projection onto the directions along which attachments hold the node
        Vec3 impulse = Vec3::Zero();  // sum of the warm-start impulses of contacts at the node [N s]
        bool in_region = false;       // true if a contact, tie or cable can move the node
    };
    Column<Index> entry;  // for each appended row, in order: row of AttachmentTable::node
    Column<Node> node;    // working memory: by row of NodeTable
};

/// Appends rows to the contacts for the held nodes that contacts, ties or solved cables can move. Each row demands the
/// prescribed velocity along one held direction of such a node. Sequential.
///
/// A contact whose gap changes only by motion along held directions is not considered: no impulses could satisfy both
/// the contact and the rows.
void prepare_held_rows(const AxisHoldInputs& inputs, const CableBlockTable& cables, Real h, ContactTable& contacts,
                       HeldRows& rows);

/// Removes the rows that prepare_held_rows() has appended to the contacts, after the solve, and adds their impulses to
/// `held_impulse`. Returns the sum and the work of these impulses. Sequential.
ExternalWork take_held_rows(const AxisHoldInputs& inputs, std::span<const Vec3> velocity_next, ContactTable& contacts,
                            const HeldRows& rows, std::span<Vec3> held_impulse);

/// Removes the error that the contact solver has left in the prescribed velocities, and adds the impulses of this
/// correction to `held_impulse`. Also removes the parts along the held directions from `push_out`. Returns the sum and
/// the work of the added impulses.
ExternalWork hold_axes_again(const AxisHoldInputs& inputs, Real h, std::span<Vec3> velocity_next,
                             std::span<Vec3> push_out, std::span<Vec3> held_impulse);

}  // namespace skerry
