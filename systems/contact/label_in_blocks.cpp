#include "systems/contact/label_in_blocks.h"

#include <algorithm>
#include <utility>

#include "jobs/parallel_for.h"

namespace skerry {
namespace {

// Limits of the division into blocks. A block has at least 2^min_shift contacts, whose processing takes a few
// microseconds, about as long as the start of a worker. There are at most max_blocks blocks, because BlockTable has an
// entry for each pair of blocks.
constexpr std::size_t min_shift = 7, max_blocks = 64;

/// Splits the contacts into blocks whose size is a power of two.
struct Blocks {
    std::size_t shift = min_shift;
    std::size_t contacts;

    explicit Blocks(std::size_t count) : contacts(count) {
        while (block_of(count - 1) >= max_blocks) ++shift;
    }
    std::size_t block_of(std::size_t contact) const { return contact >> shift; }
    std::size_t count() const { return block_of(contacts - 1) + 1; }

    /// Calls body(block, begin, end) for all blocks.
    template <class Body>
    void run(Executor& executor, Body&& body) const {
        parallel_for(executor, contacts, std::size_t{1} << shift,
                     [&](std::size_t begin, std::size_t end) { body(block_of(begin), begin, end); });
    }
};

/// Table to sort the contacts by the block in which their region begins; a region begins at its first contact. Entry
/// (a, b) first counts the contacts of block a whose region begins in block b. Then cut() replaces the count by the
/// index of the first of these contacts in the sorted list.
class BlockTable {
public:
    BlockTable(std::size_t blocks, Column<Index>& entry) : blocks_(blocks), entry_(entry) {
        entry_.assign(blocks * blocks, 0);
    }
    /// Table entries for the contacts of `block`, indexed by the block in which the region of a contact begins. Entries
    /// for later blocks are unused, because a region begins at its first contact.
    Index* row(std::size_t block) { return entry_.data() + block * blocks_; }

    /// Replaces the count in each entry (a, b) by the index of the first of these contacts in a list of all contacts.
    /// The list is sorted by the block in which the region of a contact begins, then by contact. Returns for each block
    /// b the index at which it begins in the list, followed by the length of the list.
    std::array<Index, max_blocks + 1> cut() {
        std::array<Index, max_blocks + 1> begin;
        Index sum = 0;
        for (std::size_t first = 0; first < blocks_; ++first) {
            begin[first] = sum;
            for (std::size_t block = first; block < blocks_; ++block) {
                Index& entry = row(block)[first];
                entry = std::exchange(sum, sum + entry);
            }
        }
        begin[blocks_] = sum;
        return begin;
    }

private:
    std::size_t blocks_;
    Column<Index>& entry_;
};

void join_all(Executor& executor, std::span<const JointBlock> joints, SharedUnionFind& sets) {
    parallel_for(executor, joints.size(), std::size_t{1} << min_shift, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j)
            joints[j].join_nodes([&](Index first, Index second) { sets.join(first, second); });
    });
}

/// Joins the sets of all moving nodes of a contact. `leader(node)`: the node that represents the group (rigid body or
/// cluster) of `node`. Returns a node of the joined set, or no_index if no node can move.
template <class Leader>
Index unite(const Stencil& stencil, std::span<const Real> inverse_mass, const Leader& leader, SharedUnionFind& sets) {
    Index joined = no_index;
    for (std::size_t a = 0; a < 4; ++a) {
        const Index at = stencil.node[a];
        if (stencil.weight[a] == 0 || !(inverse_mass[at] > 0)) continue;
        const Index other = leader(at);
        joined = joined == no_index ? other : sets.join(joined, other);
    }
    return joined;
}

template <class Leader>
void unite_all(Executor& executor, const Blocks& blocks, std::span<const Stencil> stencil,
               std::span<const Real> inverse_mass, const Leader& leader, SharedUnionFind& sets,
               std::span<Index> contact_node) {
    constexpr std::size_t ahead = 12;  // prefetch the data of the contact that comes this many contacts later
    blocks.run(executor, [&](std::size_t, std::size_t begin, std::size_t end) {
        const auto fetch = [&](const Stencil& next) {
            for (const Index node : next.node) {
                sets.fetch(node);
                __builtin_prefetch(&inverse_mass[node]);
            }
        };
        for (std::size_t i = begin; i < std::min(begin + ahead, end); ++i) fetch(stencil[i]);
        for (std::size_t i = begin; i < end; ++i) {
            if (i + ahead < end) fetch(stencil[i + ahead]);
            contact_node[i] = unite(stencil[i], inverse_mass, leader, sets);
        }
    });
}

/// Numbers the regions first .. last - 1 and sorts the contacts of these regions by region. `contact`: all contacts of
/// these regions in ascending order; on entry contact_region holds, for each contact, the first contact of its region.
/// `begin`: index of contact[0] in the list of the contacts of all regions.
void collect(std::span<const Index> contact, Index begin, Index first, Index last, std::span<Index> contact_region,
             Ragged<Index>& list) {
    Index* const offset = list.offset.data();
    const Index start = begin;
    std::fill(offset + first, offset + last, 0);
    Index next = first;
    for (const Index c : contact) {
        Index& region = contact_region[static_cast<std::size_t>(c)];
        // the first contact of a region comes before its other contacts, so the region already has its number
        region = region == c ? next++ : contact_region[static_cast<std::size_t>(region)];
        ++offset[region];
    }
    for (Index r = first; r < last; ++r) offset[r] = std::exchange(begin, begin + offset[r]);
    for (const Index c : contact) list.item[offset[contact_region[static_cast<std::size_t>(c)]]++] = c;
    // filling has moved each offset to the start of the next region, so move the offsets back
    for (Index r = last - 1; r > first; --r) offset[r] = offset[r - 1];
    if (first < last) offset[first] = start;
}

}  // namespace

Index label_in_blocks(Executor& executor, std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                      const NodeGroups& groups, BlockLabels& memory, Ragged<Index>& contacts,
                      std::span<Index> contact_region) {
    const Blocks blocks(stencil.size());
    SharedUnionFind& sets = memory.sets;
    sets.start(inverse_mass.size());
    join_all(executor, groups.joints, sets);
    groups.join_cables(inverse_mass, sets);
    if (groups.empty())
        unite_all(
            executor, blocks, stencil, inverse_mass, [](Index node) { return node; }, sets, contact_region);
    else
        unite_all(
            executor, blocks, stencil, inverse_mass, [&](Index node) { return groups.leader(node); }, sets,
            contact_region);
    groups.leave_out_other_ranks(stencil, contact_region);
    blocks.run(executor, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (contact_region[i] == no_index) continue;
            contact_region[i] = sets.root(contact_region[i]);
            sets.begin_with(contact_region[i], static_cast<Index>(i));
        }
    });
    // contact_region now holds the root of the set of each contact. The next loop replaces it by the first contact of
    // the region.
    BlockTable table(blocks.count(), memory.entry);
    std::array<Index, max_blocks + 1> first_region{};  // by block: number of the first region that begins in the block
    blocks.run(executor, [&](std::size_t block, std::size_t begin, std::size_t end) {
        Index* const count = table.row(block);
        Index beginning = 0;
        for (std::size_t i = begin; i < end; ++i) {
            if (contact_region[i] == no_index) continue;
            const Index first = contact_region[i] = sets.first_item(contact_region[i]);
            ++count[blocks.block_of(static_cast<std::size_t>(first))];
            beginning += first == static_cast<Index>(i);
        }
        first_region[block + 1] = beginning;
    });
    for (std::size_t block = 0; block < blocks.count(); ++block) first_region[block + 1] += first_region[block];
    const std::array<Index, max_blocks + 1> begin_of = table.cut();
    const Index region_count = first_region[blocks.count()], item_count = begin_of[blocks.count()];

    memory.by_block.resize(static_cast<std::size_t>(item_count));
    contacts.item.resize(static_cast<std::size_t>(item_count));
    contacts.offset.resize(static_cast<std::size_t>(region_count) + 1);
    contacts.offset[region_count] = item_count;
    blocks.run(executor, [&](std::size_t block, std::size_t begin, std::size_t end) {
        Index* const next = table.row(block);
        for (std::size_t i = begin; i < end; ++i)
            if (contact_region[i] != no_index)
                memory.by_block[next[blocks.block_of(static_cast<std::size_t>(contact_region[i]))]++] =
                    static_cast<Index>(i);
    });
    blocks.run(executor, [&](std::size_t block, std::size_t, std::size_t) {
        const auto begin = static_cast<std::size_t>(begin_of[block]);
        const auto end = static_cast<std::size_t>(begin_of[block + 1]);
        collect(memory.by_block.span().subspan(begin, end - begin), begin_of[block], first_region[block],
                first_region[block + 1], contact_region, contacts);
    });
    return region_count;
}

}  // namespace skerry
