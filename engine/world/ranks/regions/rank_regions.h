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

/// Identifies a node on all ranks, whose table rows differ.
struct NodeName {
    Index body = no_index;  // row of the body in the undivided world
    Index node = no_index;  // number of the node within the body

    auto operator<=>(const NodeName&) const = default;
};

/// Label of a region: the least name among its groups of nodes. The owner of the body with this name solves the region.
struct RegionLabel {
    NodeName least;
    std::int32_t owner = 0;  // rank
};

/// A contact in a message, with its friction axis and the impulse with which the solver starts. Bodies are named by
/// their rows in the undivided world. A node of the stencil is encoded as twice its number within its body, plus 1 if
/// it belongs to the second body.
struct MailedContact {
    ContactRow row;
    FrictionAxis friction_axis;
    Vec3 impulse = Vec3::Zero();  // [N s]
};

/// The bodies of a rank and the other ranks that hold them.
struct SharedBodies {
    std::span<const Index> place;                  // RankState
    std::span<const std::int32_t> owner;           // RankState
    const std::vector<std::vector<int>>& holders;  // RankState
    const std::vector<int>& peers;                 // RankState
    int rank;
    std::span<const BodyKind> kind;    // BodyTable
    std::span<const Range> nodes;      // BodyTable
    std::span<const Index> node_body;  // NodeTable

    static SharedBodies bind(const Binder& binder, const RankState& ranks, const BodyTable& body,
                             const NodeTable& node);

    std::size_t size() const { return place.size(); }
    Index body_of(Index node) const { return node_body[static_cast<std::size_t>(node)]; }
    /// Indices in `peers` of the other ranks that hold a body.
    std::span<const int> holders_of(Index body) const { return holders[static_cast<std::size_t>(body)]; }
    bool is_held_by(int peer, Index body) const;
    /// Index of a rank in `peers`; -1 if the rank is no peer.
    int peer_of(int rank) const;
    NodeName name(Index node) const {
        const auto body = static_cast<std::size_t>(body_of(node));
        return {place[body], node - nodes[body].begin};
    }
    /// Row of BodyTable of the body in a row of the undivided world; no_index if this rank does not hold the body.
    Index row_of(Index of_place) const { return row_of_place(place, of_place); }
    /// Row of NodeTable; no_index if this rank does not hold the body.
    Index node_of(const NodeName& name) const {
        const Index body = row_of(name.body);
        return body == no_index ? no_index : nodes[static_cast<std::size_t>(body)].begin + name.node;
    }
};

/// Data of an attempt at a step about regions that several ranks touch, and working memory.
struct RankRegions {
    RankMail mail;
    // For each body: first body of its unit, which is the set of bodies that rows of joints, ties or cables join.
    // no_index: no such row acts on the unit. Empty if there are no such rows.
    Column<Index> unit;
    // For each body: 1 if the rows of joints, ties and cables of its unit are solved by another rank. Empty if `unit`
    // is empty.
    Column<std::uint8_t> elsewhere;
    // True if this rank solves other contacts than those that it has found. `found` then has the contacts that it has
    // found, and the contact table has those that it solves, until take_back_rows exchanges the tables.
    bool exchanged = false;
    ContactTable found;
    // For each row of `found`: row in the contact table, or -1 - p for a row that was sent to peer p.
    Column<Index> solved_row;
    Column<MailedContact> received;  // contacts from other ranks, in the order of the peers
    Column<Index> received_end;      // by peer: end of its contacts in `received`
    Column<Index> received_row;      // for each row of `received`: row in the contact table
    std::size_t contact_count = 0;   // number of contacts that this rank solves; rows of ties follow
    // Bodies that contacts of other ranks touch in this attempt. A body may be listed several times.
    Column<Index> touched_bodies;
    bool pushed = false;  // true if another rank has pushed nodes of this rank apart in this attempt

    UnionFind sets;                // sets of groups of nodes in contact; later reused to mark visited nodes
    UnionFind body_sets;           // sets of joined bodies
    Column<std::uint8_t> in_unit;  // by body: 1 if a row of a joint, tie or cable acts on it
    Column<RegionLabel> label;     // by node; valid for groups of nodes that contacts of this rank touch
    Column<Index> group;           // first nodes of these groups
    Column<Index> group_of;        // by contact: a group that it touches, or no_index
    // by node; valid at the roots of `sets`: 1 if another rank touches the region too
    Column<std::uint8_t> open;
    Column<int> changed;           // by node; valid at the roots of `sets`: last round in which the label changed
    Column<Index> unit_count;      // by peer: number of units whose rows it solves
    Column<Index> order, source;   // used to merge contacts
    Column<Index> nodes, bodies;   // nodes and bodies that the regions of this rank have moved
    Column<std::uint8_t> visited;  // by body
    Column<int> unit_from;         // by body that is first in its unit: peer that has solved the rows of the unit
};

}  // namespace skerry
