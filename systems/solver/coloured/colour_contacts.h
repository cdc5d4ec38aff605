// Order of a region's contacts that allows solving many of them concurrently: colour after colour, with no node twice
// in a colour (docs/methods/region_solver.md 6.1).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// The moving nodes of a contact, then no_index. A node may occur twice.
using ContactNodes = std::array<Index, 4>;

/// Contacts of a block are solved one after the other by one thread. Blocks of a phase share no node and are solved
/// concurrently; phases follow each other. The result is bitwise that of solving the contacts one by one in this order.
struct ColouredOrder {
    Column<Index> contact;       // number of the contact in the region, by place in the order
    Column<Index> block_offset;  // first place of each block, and the end
    Column<Index> phase_offset;  // first block of each phase, and the end
    Index colour_count = 0;      // number of phases of contacts that share no node; they come first
    Index hub_phase_count = 0;   // number of phases of hub blocks; they come next
    Index tail_size = 0;         // number of contacts in the last phase, a single block; 0 if it does not exist
};

struct ColouringMemory {
    Column<std::uint64_t> colours_used;  // by node, one bit per colour
    Column<Index> degree;                // by node: number of its contacts
    Column<Index> hub_of_node;           // by node: its number among the hubs, or no_index
    Column<Index> bin;                   // by contact: its colour, 64 for the tail, or 65 + its hub
    Column<Index> bin_begin;             // by bin: number of its contacts, then the place of the next one
    Column<Index> hub_offset, hub_item;  // contacts of each hub
    Column<Index> hub_order, hub_colour;
    Column<Index> node_offset, by_node;  // contacts sorted by the lowest of their nodes
};

/// A node with more contacts than this is a hub. Each of its contacts would need its own colour: matched meshes take 7
/// to 10 colours, a coarse mesh under a finer one hundreds. The contacts of a hub form one block, and blocks of hubs
/// are coloured instead.
inline constexpr Index hub_degree = 32;
/// Colours with fewer contacts than this (one block) do not justify a phase. They go to the tail, in the order of the
/// contacts.
inline constexpr Index smallest_colour = 64;

/// Greedy colouring in the order of the contacts, with 64 colours; contacts without a free colour go to the tail. The
/// result depends only on the arguments. Nodes are numbered 0 .. node_count - 1. Within a colour contacts are sorted by
/// their nodes, so that equal shares of different colours use the same nodes.
void colour_contacts(std::span<const ContactNodes> contact, Index node_count, ColouringMemory& memory,
                     ColouredOrder& order);

}  // namespace skerry
