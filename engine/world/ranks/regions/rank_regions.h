// Contact regions that cross the borders of ranks (docs/methods/ranks.md 3). Each region is solved by one rank.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "components/body_table.h"
#include "components/contact_table.h"
#include "components/node_table.h"
#include "components/union_find.h"
#include "engine/world/ranks/rank_state.h"
#include "engine/world/ranks/regions/rank_mail.h"
#include "jobs/access.h"

namespace skerry {

/// Names a node in the same way on all ranks. The row of the node in NodeTable differs between ranks.
struct NodeName {
    Index body = no_index;  // row of the body in the undivided world
    Index node = no_index;  // number of the node within the body

    auto operator<=>(const NodeName&) const = default;
};

/// Label of a contact region: the least NodeName among the first nodes of its groups (nodes that move together). The
/// rank that owns the body `least.body` solves the region.
struct RegionLabel {
    NodeName least;
    std::int32_t owner = 0;  // rank
};

/// A contact in a message, with its friction axis and the impulse with which the solver starts. Bodies are named by
/// their rows in the undivided world. In the stencil, node n of the first body is encoded as 2 n, and node n of the
/// second body as 2 n + 1.
struct MailedContact {
    ContactRow row;
    FrictionAxis friction_axis;
    Vec3 impulse = Vec3::Zero();  // [N s]
};

/// The bodies of a rank and the other ranks that hold them.
struct SharedBodies {
    std::span<const Index> world_row;              // by body: its row in the undivided world
    std::span<const std::int32_t> owner;           // RankState
    const std::vector<std::vector<int>>& holders;  // RankState
    const std::vector<int>& peers;                 // RankState
    int rank;
    std::span<const BodyKind> kind;    // BodyTable
    std::span<const Range> nodes;      // BodyTable
    std::span<const Index> node_body;  // NodeTable

    static SharedBodies bind(const Binder& binder, const RankState& ranks, const BodyTable& body,
                             const NodeTable& node);

    std::size_t size() const { return world_row.size(); }
    Index body_of(Index node) const { return node_body[static_cast<std::size_t>(node)]; }
    /// Indices in `peers` of the other ranks that hold a body.
    std::span<const int> holders_of(Index body) const { return holders[static_cast<std::size_t>(body)]; }
    bool is_held_by(int peer, Index body) const;
    /// Index of a rank in `peers`; -1 if the rank is no peer.
    int peer_of(int rank) const;
    NodeName name(Index node) const {
        const auto body = static_cast<std::size_t>(body_of(node));
        return {world_row[body], node - nodes[body].begin};
    }
    /// Row of BodyTable of the body with the row `row_in_world` in the undivided world; no_index if this rank does not
    /// hold it.
    Index row_of(Index row_in_world) const { return local_row(world_row, row_in_world); }
    /// Row of NodeTable; no_index if this rank does not hold the body.
    Index node_of(const NodeName& name) const {
        const Index body = row_of(name.body);
        return body == no_index ? no_index : nodes[static_cast<std::size_t>(body)].begin + name.node;
    }
};

/// Data about the regions with bodies of several ranks in one attempt at a step, and working memory.
struct RankRegions {
    RankMail mail;
    // For each body: first body of its unit, a set of bodies that joints, ties, cables, springs or other rows connect.
    // no_index: no joint, tie or cable acts on the unit. Empty if there are no joints, ties and cables.
    Column<Index> unit;
    // For each body: 1 if the rows of joints, ties and cables of its unit are solved by another rank. Empty if `unit`
    // is empty.
    Column<std::uint8_t> solved_elsewhere;
    // True if the contacts that this rank solves are not those that it has found. The contact table then contains the
    // solved ones and `found` the found ones, until take_back_rows exchanges the tables.
    bool exchanged = false;
    ContactTable found;
    // For each row of `found`: row in the contact table, or -1 - p for a row that was sent to peer p.
    Column<Index> solved_row;
    Column<MailedContact> received;  // contacts from other ranks, in the order of the peers
    Column<Index> received_end;      // by peer: end of its contacts in `received`
    Column<Index> received_row;      // for each row of `received`: row in the contact table
    std::size_t contact_count = 0;   // number of contacts that this rank solves; rows of ties follow
    // Bodies with nodes whose velocities this rank has sent or received after the solve of this attempt. A body may be
    // listed several times.
    Column<Index> touched_bodies;
    bool pushed = false;  // true if another rank has computed a push-out of nodes of this rank in this attempt

    // Joins groups of nodes that contacts connect. After the solve, its nodes serve a second purpose: list_moved marks
    // in them the nodes that it has visited.
    UnionFind sets;
    UnionFind body_sets;  // sets of joined bodies
    // by body; valid at the roots of `body_sets`: 1 if a joint, tie or cable acts on the set
    Column<std::uint8_t> in_unit;
    Column<RegionLabel> label;  // by node; valid at the nodes in `group`
    // First nodes of the groups that contacts of this rank touch, and of the units that this rank owns. All nodes of
    // such a unit form one group.
    Column<Index> group;
    Column<Index> group_of;  // by contact: first node of one of its groups; no_index: none of its nodes can move
    // by node; valid at the roots of `sets`: 1 if another rank has sent a label for a group of the region
    Column<std::uint8_t> label_received;
    Column<int> changed;           // by node; valid at the roots of `sets`: last round in which the label changed
    Column<Index> unit_count;      // by peer: number of own units that the peer solves
    Column<Index> order, source;   // working memory of RowExchange::merge
    Column<Index> nodes, bodies;   // nodes and bodies that the regions of this rank have moved
    Column<std::uint8_t> visited;  // by body: 1 if listed in `bodies`
    Column<int> unit_from;         // by first body of a unit: peer that has solved the rows of the unit; -1: none
};

}  // namespace skerry
