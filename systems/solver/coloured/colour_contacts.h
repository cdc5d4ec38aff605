// An order of a region's contacts in which many are solved at the same time: colour after colour, no node twice in a
// colour (docs/methods/region_solver.md 6.1).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// The moving nodes of a contact, no_index behind the last. A node may be named twice.
using ContactNodes = std::array<Index, 4>;

/// Contacts of a block are solved one after the other by one thread; blocks of a phase share no node and are solved at
/// the same time; phases follow each other. So the result is that of solving the contacts one by one in this order, to
/// the last bit.
struct ColouredOrder {
    Column<Index> contact;       // by place in the order: number of the contact in the region
    Column<Index> block_offset;  // by block: its first place; and one more
    Column<Index> phase_offset;  // by phase: its first block; and one more
    Index colour_count = 0;      // phases of contacts that share no node; they come first
    Index hub_phase_count = 0;   // phases of hub blocks; they come next
    Index tail_size = 0;         // contacts of the last phase, a single block; 0: there is none
};

struct ColouringMemory {
    Column<std::uint64_t> colours_used;  // by node, a bit for each colour
    Column<Index> degree;                // by node: contacts that name it
    Column<Index> hub_of_node;           // by node: its number among the hubs
    Column<Index> bin;                   // by contact: its colour, or 64 + its hub
    Column<Index> bin_begin;             // by bin: contacts in it, then the place of the next
    Column<Index> hub_offset, hub_item;  // by hub: its contacts
    Column<Index> hub_order, hub_colour;
    Column<Index> node_offset, by_node;  // contacts by the lowest of their nodes
};

/// A node that more contacts name than this is a hub: each of them would need a colour of its own (matched meshes take
/// 7 to 10 colours, a coarse one under a finer one hundreds). Its contacts are one block, and blocks of hubs are
/// coloured instead.
inline constexpr Index hub_degree = 32;
/// Colours with fewer contacts than this, a block, are not worth a phase: they go to the tail, in the order of the
/// contacts.
inline constexpr Index smallest_colour = 64;

/// Greedy, in the order of the contacts, with 64 colours; what finds none goes to the tail. Depends on nothing but its
/// arguments. Nodes are numbered 0 .. node_count - 1. Within a colour contacts follow the numbers of their nodes, so
/// that the same share of every colour is at the same nodes.
void colour_contacts(std::span<const ContactNodes> contact, Index node_count, ColouringMemory& memory,
                     ColouredOrder& order);

}  // namespace skerry
