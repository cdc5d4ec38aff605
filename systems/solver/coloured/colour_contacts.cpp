#include "systems/solver/coloured/colour_contacts.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace skerry {
namespace {

constexpr Index colour_limit = 64;  // bits of ColouringMemory::colours_used
// Bin for the tail, the contacts that get no colour. The bins of the hubs (nodes with many contacts) follow.
constexpr Index tail_bin = colour_limit;

/// Number of blocks into which the contacts of one colour are divided. One worker solves a block, of at most 64
/// contacts. This takes a microsecond, claiming the block a twentieth of that.
Index blocks_of_colour(Index contacts) {
    // The number of blocks is a power of two or a multiple of `even_workers`. So 2, 4, 8 or 16 workers get equal
    // numbers of blocks, if there are enough.
    constexpr std::uint32_t max_contacts = 64, even_workers = 16;
    const std::uint32_t least = (static_cast<std::uint32_t>(contacts) + max_contacts - 1) / max_contacts;
    return static_cast<Index>(least <= even_workers ? std::bit_ceil(least)
                                                    : (least + even_workers - 1) / even_workers * even_workers);
}

template <class Visit>
void for_each_node(const ContactNodes& nodes, Visit&& visit) {
    for (const Index node : nodes) {
        if (node == no_index) return;
        visit(node);
    }
}

/// colour() is the lowest colour that is still free at all nodes passed to exclude(), or colour_limit if there is none.
/// mark_used() marks this colour as used at the given nodes.
struct FreeColour {
    ColouringMemory& memory;
    std::uint64_t used = 0;

    void exclude(const ContactNodes& nodes) {
        for_each_node(nodes, [&](Index node) { used |= memory.colours_used[node]; });
    }
    Index colour() const { return std::countr_one(used); }
    void mark_used(const ContactNodes& nodes) const {
        if (colour() == colour_limit) return;
        const std::uint64_t bit = std::uint64_t{1} << colour();
        for_each_node(nodes, [&](Index node) { memory.colours_used[node] |= bit; });
    }
};

void count_degrees(std::span<const ContactNodes> contact, Index node_count, ColouringMemory& memory) {
    memory.degree.assign(static_cast<std::size_t>(node_count), 0);
    for (const ContactNodes& nodes : contact) for_each_node(nodes, [&](Index node) { ++memory.degree[node]; });
}

/// Assigns each contact to a bin. A contact of a hub (a node with many contacts) goes into the bin of its first hub.
/// Any other contact goes into the bin of its colour, or of the tail if no colour is free. Returns the number of hubs.
Index fill_bins(std::span<const ContactNodes> contact, Index node_count, ColouringMemory& memory) {
    const bool has_hubs =
        std::any_of(memory.degree.begin(), memory.degree.end(), [](Index degree) { return degree > hub_degree; });
    memory.colours_used.assign(static_cast<std::size_t>(node_count), 0);
    memory.bin.resize(contact.size());
    memory.bin_begin.assign(colour_limit + 1, 0);
    if (has_hubs) memory.hub_of_node.assign(static_cast<std::size_t>(node_count), no_index);
    Index hub_count = 0;
    for (std::size_t k = 0; k < contact.size(); ++k) {
        const ContactNodes& nodes = contact[k];
        if (has_hubs) {
            Index hub = no_index;
            for_each_node(nodes, [&](Index node) {
                if (hub == no_index && memory.degree[node] > hub_degree) hub = node;
            });
            if (hub != no_index) {
                Index& number = memory.hub_of_node[hub];
                if (number == no_index) {
                    number = hub_count++;
                    memory.bin_begin.push_back(0);
                }
                memory.bin[k] = tail_bin + 1 + number;
                ++memory.bin_begin[memory.bin[k]];
                continue;
            }
        }
        FreeColour free{memory};
        free.exclude(nodes);
        free.mark_used(nodes);
        memory.bin[k] = free.colour();
        ++memory.bin_begin[memory.bin[k]];
    }
    return hub_count;
}

/// Lists the contacts of each hub (node with many contacts) in ascending order.
void list_hubs(Index hub_count, ColouringMemory& memory) {
    memory.hub_offset.assign(static_cast<std::size_t>(hub_count) + 1, 0);
    for (Index hub = 0; hub < hub_count; ++hub)
        memory.hub_offset[hub + 1] = memory.hub_offset[hub] + memory.bin_begin[tail_bin + 1 + hub];
    memory.hub_item.resize(static_cast<std::size_t>(memory.hub_offset.back()));
    memory.hub_order.assign(static_cast<std::size_t>(hub_count), 0);
    for (std::size_t k = 0; k < memory.bin.size(); ++k) {
        const Index hub = memory.bin[k] - tail_bin - 1;
        if (hub >= 0) memory.hub_item[memory.hub_offset[hub] + memory.hub_order[hub]++] = static_cast<Index>(k);
    }
}

/// Gives each hub block (the contacts of one hub) a colour. Then sorts the hubs by colour, and hubs of one colour by
/// their index.
void colour_hubs(std::span<const ContactNodes> contact, Index hub_count, ColouringMemory& memory) {
    list_hubs(hub_count, memory);
    std::fill(memory.colours_used.begin(), memory.colours_used.end(), 0);
    memory.hub_colour.resize(static_cast<std::size_t>(hub_count));
    for (Index hub = 0; hub < hub_count; ++hub) {
        const std::span<const Index> row = std::span<const Index>(memory.hub_item.span())
                                               .subspan(static_cast<std::size_t>(memory.hub_offset[hub]),
                                                        static_cast<std::size_t>(memory.bin_begin[tail_bin + 1 + hub]));
        FreeColour free{memory};
        for (const Index k : row) free.exclude(contact[k]);
        for (const Index k : row) free.mark_used(contact[k]);
        memory.hub_colour[hub] = free.colour();
        memory.hub_order[hub] = hub;
    }
    std::sort(memory.hub_order.begin(), memory.hub_order.end(), [&](Index a, Index b) {
        return std::pair(memory.hub_colour[a], a) < std::pair(memory.hub_colour[b], b);
    });
}

/// Computes the phases and blocks of the coloured order. On entry bin_begin holds the number of contacts of each bin.
/// Layout replaces this number by the index of the bin's first contact in the coloured order, or by no_index if the
/// contacts go to the tail (the last phase, solved by one worker).
class Layout {
public:
    Layout(ColouringMemory& memory, ColouredOrder& order) : memory_(memory), order_(order) {
        order_.block_offset.clear();
        order_.phase_offset.clear();
        order_.colour_count = order_.hub_phase_count = order_.tail_size = 0;
    }

    void add_colours() {
        for (Index colour = 0; colour < colour_limit; ++colour) {
            Index& begin = memory_.bin_begin[colour];
            if (begin < smallest_colour) {
                move_to_tail(begin);
                continue;
            }
            const Index count = begin, blocks = blocks_of_colour(count);
            begin_phase();
            begin = next_;
            for (Index b = 0; b < blocks; ++b)
                order_.block_offset.push_back(next_ + static_cast<Index>(std::int64_t{count} * b / blocks));
            next_ += count;
            ++order_.colour_count;
        }
    }

    void add_hubs(Index hub_count) {
        for (Index first = 0, last = 0; first < hub_count; first = last) {
            const Index colour = memory_.hub_colour[memory_.hub_order[first]];
            Index contacts = 0;
            for (; last < hub_count && memory_.hub_colour[memory_.hub_order[last]] == colour; ++last)
                contacts += bin_of(last);
            const bool alone = colour == colour_limit || contacts < smallest_colour;
            if (!alone) {
                begin_phase();
                ++order_.hub_phase_count;
            }
            for (Index h = first; h < last; ++h) {
                Index& begin = bin_of(h);
                if (alone) {
                    move_to_tail(begin);
                    continue;
                }
                const Index count = begin;
                begin = next_;
                order_.block_offset.push_back(next_);
                next_ += count;
            }
        }
    }

    /// Adds the phase of the tail. Returns the index of the tail's first contact in the order.
    Index add_tail() {
        move_to_tail(memory_.bin_begin[tail_bin]);
        const Index begin = next_;
        if (order_.tail_size > 0) {
            begin_phase();
            order_.block_offset.push_back(begin);
            next_ += order_.tail_size;
        }
        begin_phase();  // end marker
        order_.block_offset.push_back(next_);
        return begin;
    }

private:
    Index& bin_of(Index h) { return memory_.bin_begin[tail_bin + 1 + memory_.hub_order[h]]; }
    void begin_phase() { order_.phase_offset.push_back(static_cast<Index>(order_.block_offset.size())); }
    void move_to_tail(Index& bin) {
        order_.tail_size += bin;
        bin = no_index;
    }

    ColouringMemory& memory_;
    ColouredOrder& order_;
    Index next_ = 0;
};

/// Lists the contacts in `by_node`, sorted by the lowest number of their moving nodes. Contacts with equal lowest node
/// stay in ascending order.
void sort_by_node(std::span<const ContactNodes> contact, Index node_count, ColouringMemory& memory) {
    const auto lowest = [&](const ContactNodes& nodes) {
        Index node = std::max(nodes[0], Index(0));
        for_each_node(nodes, [&](Index other) { node = std::min(node, other); });
        return node;
    };
    // Contacts without a node are sorted as if they had node 0. The arrays get an entry for node 0 even if no node
    // exists.
    memory.node_offset.assign(static_cast<std::size_t>(std::max(node_count, Index(1))) + 2, 0);
    for (const ContactNodes& nodes : contact) ++memory.node_offset[lowest(nodes) + 2];
    for (std::size_t n = 2; n < memory.node_offset.size(); ++n) memory.node_offset[n] += memory.node_offset[n - 1];
    memory.by_node.resize(contact.size());
    for (std::size_t k = 0; k < contact.size(); ++k)
        memory.by_node[memory.node_offset[lowest(contact[k]) + 1]++] = static_cast<Index>(k);
}

/// Writes the coloured order. Contacts of one colour are sorted by node, so that a worker meets mostly the same nodes
/// in all colours and finds them in its cache (see Team::run_phases). Contacts of hubs and of the tail stay in
/// ascending order.
void place_contacts(std::span<const ContactNodes> contact, Index node_count, Index tail, ColouringMemory& memory,
                    ColouredOrder& order) {
    sort_by_node(contact, node_count, memory);
    order.contact.resize(contact.size());
    const auto in_colour = [&](Index bin) { return bin < colour_limit && memory.bin_begin[bin] != no_index; };
    for (const Index k : memory.by_node)
        if (const Index bin = memory.bin[k]; in_colour(bin)) order.contact[memory.bin_begin[bin]++] = k;
    for (std::size_t k = 0; k < contact.size(); ++k) {
        const Index bin = memory.bin[k];
        if (in_colour(bin)) continue;
        Index& begin = memory.bin_begin[bin];
        order.contact[begin == no_index ? tail++ : begin++] = static_cast<Index>(k);
    }
}

}  // namespace

void colour_contacts(std::span<const ContactNodes> contact, Index node_count, ColouringMemory& memory,
                     ColouredOrder& order) {
    count_degrees(contact, node_count, memory);
    const Index hub_count = fill_bins(contact, node_count, memory);
    if (hub_count > 0) colour_hubs(contact, hub_count, memory);

    Layout layout(memory, order);
    layout.add_colours();
    layout.add_hubs(hub_count);
    place_contacts(contact, node_count, layout.add_tail(), memory, order);
}

}  // namespace skerry
