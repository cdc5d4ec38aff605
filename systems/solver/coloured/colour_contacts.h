// Coloured order of a region's contacts. Contacts of one colour share no moving node, so they can be solved
// concurrently (docs/methods/region_solver.md 6.1).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Moving nodes of a contact, padded with no_index. A node may occur twice.
using ContactNodes = std::array<Index, 4>;

/// An order of the contacts of a region in which threads can solve them concurrently. The impulses are bitwise equal to
/// those of one thread that solves the contacts in this order. The order consists of phases, and each phase of blocks:
/// - Phases are solved one after the other.
/// - Blocks of a phase share no node and are solved concurrently.
/// - Contacts of a block are solved one after the other by one thread.
struct ColouredOrder {
    Column<Index> contact;       // the coloured order: numbers of the contacts in the region
    Column<Index> block_offset;  // index in `contact` of each block's first contact; last entry: contact count
    Column<Index> phase_offset;  // index of the first block of each phase; the last entry is the block count
    Index colour_count = 0;      // number of phases in which no two contacts share a node; these phases come first
    Index hub_phase_count = 0;   // number of phases for contacts of hubs (see hub_degree); they follow the colours
    Index tail_size = 0;         // number of contacts in the tail, the last phase, which is one block; 0 without tail
};

struct ColouringMemory {
    Column<std::uint64_t> colours_used;  // by node: bit set of the colours of the contacts at the node
    Column<Index> degree;                // by node: number of contacts at the node
    Column<Index> hub_of_node;           // by node: index of the node among the hubs, or no_index
    Column<Index> bin;                   // by contact: colour, or 64 for the tail, or 65 + index of a hub
    // by bin: number of contacts; later the index in ColouredOrder::contact at which the next contact of the bin is
    // placed
    Column<Index> bin_begin;
    // hub_item: lists of the contacts of the hubs, one list after the other; hub_offset: start of the list of each hub
    Column<Index> hub_offset, hub_item;
    Column<Index> hub_order, hub_colour;
    // by_node: contacts sorted by their lowest node number; node_offset: for each node, index in by_node of its first
    // contact
    Column<Index> node_offset, by_node;
};

/// A node with more contacts than this number is a hub, for example a node of a coarse mesh under a fine one. All
/// contacts of a node need different colours: two meshes of similar fineness take 7 to 10, a hub may need hundreds. So
/// the contacts of a hub form one block, and colours are given to whole blocks.
inline constexpr Index hub_degree = 32;
/// A colour with fewer contacts than this number (one block) does not justify a phase of its own. Its contacts go to
/// the tail, the last phase, which is solved by one worker.
inline constexpr Index smallest_colour = 64;

/// Colours the contacts greedily in ascending order, with at most 64 colours. Contacts without a free colour go to the
/// tail. Contacts of a colour are sorted by node, so that a worker of a Team meets mostly the same nodes in all
/// colours. Nodes are numbered 0 .. node_count - 1. The result depends only on the arguments.
void colour_contacts(std::span<const ContactNodes> contact, Index node_count, ColouringMemory& memory,
                     ColouredOrder& order);

}  // namespace skerry
