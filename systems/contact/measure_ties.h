// Measures ties after the solve: their impulses and work, and which tied nodes break off.
#pragma once

#include <span>

#include "components/cable_table.h"
#include "components/contact_table.h"
#include "components/ghost_marks.h"
#include "components/node_table.h"
#include "components/tie_table.h"
#include "jobs/access.h"
#include "systems/contact/measure_contacts.h"

namespace skerry {

struct TieMeasures {
    // impulse that moving nodes get through ties from the world, colliders and held nodes [N s]
    Vec3 impulse = Vec3::Zero();
    Real work = 0;  // work of ties on all moving nodes and bodies [J]
};

/// Nodes and bodies after the solve.
struct TieWorkInputs {
    std::span<const Real> inverse_mass;             // by node [1/kg]
    std::span<const Vec3> position;                 // by node [m]
    std::span<const Vec3> velocity, velocity_next;  // by node [m/s]
    RoundSpins spins;
    std::span<const Index> node_body;  // NodeTable
    GhostMarks ghosts;

    static TieWorkInputs bind(const Binder& binder, const NodeTable& node, const BodyTable& body,
                              const RigidBodyTable& rigid) {
        return {.inverse_mass = binder.read(node.inverse_mass),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .velocity_next = binder.read(node.velocity_next),
                .spins = RoundSpins::bind(binder, node, body, rigid),
                .node_body = binder.read(node.body),
                .ghosts = {binder.read(body.ghost)}};
    }
};

/// Removes the rows of tied nodes, which follow the contacts in `contacts` during the solve, and stores their impulses
/// in `rows`. Returns sums over these rows and over the ties of the kind `ball`, which are in `blocks`. Nodes of ghosts
/// (bodies that other ranks own) do not count. Sequential, in row order.
TieMeasures take_tie_rows(const TieWorkInputs& motion, const CableBlockTable& blocks, ContactTable& contacts,
                          TieRowTable& rows);

/// Data of the solved ties of the kind `ball`, whose impulse acts on the mean of their nodes. `mass` serves to divide
/// the impulse among the nodes.
struct BallTies {
    const CableBlockTable& blocks;
    std::span<const Range> body_nodes, body_implicit;  // BodyTable
    std::span<const Real> mass;                        // by node [kg]

    static BallTies bind(const Binder& binder, const CableBlockTable& blocks, const BodyTable& body,
                         const NodeTable& node) {
        return {.blocks = binder.read(blocks),
                .body_nodes = binder.read(body.nodes),
                .body_implicit = binder.read(body.implicit),
                .mass = binder.read(node.mass)};
    }
};

/// Times of a step [s]. `end`: simulated time at its end. `h`: its length. `kick`: force interval, the time for which
/// forces act on bodies that are not implicit.
struct TieTimes {
    Real end = 0, h = 0, kick = 0;
};

/// Stores the impulses and the largest forces of an accepted step. A node breaks off if its force exceeds the limit of
/// its tie; a tie of the kind `ball` breaks as a whole. Returns the number of ties that have lost their last node in
/// this step.
Index store_ties(const TieRowTable& rows, const BallTies& ball_ties, const TieTimes& times, TieTable& ties);

}  // namespace skerry
