#include "systems/collision/find_contacts.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "components/prefetch_lines.h"
#include "components/write_contact.h"
#include "jobs/parallel_for.h"
#include "systems/collision/contact_rows.h"
#include "systems/collision/cylinders/rigid_cylinder.h"
#include "systems/collision/pair_contacts.h"
#include "systems/collision/surface_contacts.h"

namespace skerry {

namespace {

// Amounts of work; the unit is the test of one candidate of two surfaces.
//
// Work of one block. A block takes a microsecond if no candidate can touch in this step, and a hundred microseconds if
// all must be tested.
constexpr std::int64_t candidates_per_block = 1536;
// work per pair, independent of its candidates
constexpr Index work_of_pair = 16;
// work per candidate of a body and a collider; above 1, because only candidates of two surfaces are tested in groups of
// eight
constexpr Index work_of_collider_candidate = 5;

constexpr std::size_t contacts_per_block = 256;
// While the candidates of pair p are tested, the list of pair p + pairs_ahead is prefetched (prefetch_list).
constexpr Index pairs_ahead = 3;
constexpr std::size_t counted_pairs_per_block = 512;  // number of pairs whose work is estimated by one task

bool collider_stands_still(const CollisionInputs& inputs, Index collider) {
    return inputs.collider.motion[collider].stands_still();
}

bool body_stands_still(const CollisionInputs& inputs, Index body) {
    if (inputs.body.kind[body] == BodyKind::kinematic) return collider_stands_still(inputs, inputs.body.collider[body]);
    return inputs.body.asleep[body] != 0;
}

/// Work of testing one candidate of a pair, in the unit of candidates_per_block.
Index work_of_one(const PairTable& pairs, std::size_t p) {
    return pairs.kind[p] == PairKind::collider ? work_of_collider_candidate : 1;
}

/// Work of testing all candidates of a pair, in the unit of candidates_per_block.
std::int64_t work_of(const PairTable& pairs, std::size_t p) {
    const Index count = pairs.test_count[p];
    return count == 0 ? 0 : std::int64_t{count} * work_of_one(pairs, p) + work_of_pair;
}

/// Prepares the division of the work into blocks:
/// - Marks pairs as idle if neither partner moves. They are not tested: their last contacts remain valid, because
///   bodies are only put to sleep in equilibrium.
/// - Counts the candidates of all other pairs.
/// - Adds up the work of testing them for each group of counted_pairs_per_block consecutive pairs.
void mark_idle(Executor& executor, const CollisionInputs& inputs, PairTable& pairs) {
    pairs.idle.resize(pairs.size());
    pairs.test_count.resize(pairs.size());
    pairs.work.resize((pairs.size() + counted_pairs_per_block - 1) / counted_pairs_per_block);
    parallel_for(executor, pairs.size(), counted_pairs_per_block, [&](std::size_t begin, std::size_t end) {
        std::int64_t work = 0;
        for (std::size_t p = begin; p < end; ++p) {
            pairs.idle[p] = inputs.body.asleep[pairs.first[p]] &&
                            (pairs.kind[p] == PairKind::collider ? collider_stands_still(inputs, pairs.second[p])
                                                                 : body_stands_still(inputs, pairs.second[p]));
            pairs.test_count[p] = pairs.idle[p] ? 0 : static_cast<Index>(pairs.candidates[p].size());
            work += work_of(pairs, p);
        }
        pairs.work[begin / counted_pairs_per_block] = work;
    });
}

/// Divides the concatenated candidate lists of all pairs that are not idle into blocks of equal work. Returns the
/// number of blocks.
/// - pairs.block receives the start of each block and the end of the last one.
/// - pairs.work: the work of each group of pairs (mark_idle) is replaced by the sum over the groups before it.
Index cut_blocks(Executor& executor, PairTable& pairs) {
    std::int64_t total = 0;
    for (std::int64_t& work : pairs.work) total += std::exchange(work, total);
    const auto blocks = static_cast<Index>((total + candidates_per_block - 1) / candidates_per_block);
    pairs.block.resize(static_cast<std::size_t>(blocks) + 1);
    pairs.block[blocks] = {static_cast<Index>(pairs.size()), 0};
    parallel_for(executor, pairs.size(), counted_pairs_per_block, [&](std::size_t begin, std::size_t end) {
        std::int64_t before = pairs.work[begin / counted_pairs_per_block];
        // Number of the next block whose start is to be found.
        std::int64_t next = (before + candidates_per_block - 1) / candidates_per_block;
        for (std::size_t p = begin; p < end; ++p) {
            const std::int64_t until = before + work_of(pairs, p);
            for (; next * candidates_per_block < until; ++next) {
                const std::int64_t candidate = (next * candidates_per_block - before) / work_of_one(pairs, p);
                pairs.block[next] = {static_cast<Index>(p),
                                     static_cast<Index>(std::min<std::int64_t>(candidate, pairs.test_count[p]))};
            }
            before = until;
        }
    });
    return blocks;
}

/// Prefetches the beginning of the asleep_until column of a pair, which the test of the pair reads first; the hardware
/// prefetches the rest. The columns are scattered in memory, and waiting for them would take a considerable part of the
/// time of find_contacts.
void prefetch_list(const PairTable& pairs, Index p) {
    constexpr std::size_t begin = 32;
    if (p < static_cast<Index>(pairs.size())) prefetch_lines(pairs.asleep_until[p].data(), begin);
}

void test_block(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index b, PairTable& pairs) {
    const CandidateIndex begin = pairs.block[b], end = pairs.block[b + 1];
    Column<ContactRow>& found = pairs.found[b];
    Column<NearCandidate>& near = pairs.near[b];
    found.clear();
    near.clear();
    Real nearest = infinity;
    SurfaceContacts surfaces(inputs, settings, h, pairs, found, near);
    for (Index p = begin.pair; p < static_cast<Index>(pairs.size()) && p <= end.pair; ++p) {
        const Index from = p == begin.pair ? begin.candidate : 0;
        const Index to = p == end.pair ? end.candidate : static_cast<Index>(pairs.candidates[p].size());
        prefetch_list(pairs, p + pairs_ahead);
        if (from >= to || pairs.idle[p]) continue;
        const bool cylinder = has_cylinder(inputs, pairs, p);
        if (!cylinder && pairs.kind[p] != PairKind::collider) {
            surfaces.add(p, {from, to});
            continue;
        }
        surfaces.test();  // tests the pairs collected so far first, so that contacts are appended in pair order
        const auto find = cylinder ? find_cylinder_contacts : find_collider_contacts;
        nearest = std::min(nearest, find(inputs, settings, h, p, {from, to}, pairs, found));
    }
    surfaces.test();
    pairs.block_nearest[b] = std::min(nearest, surfaces.least_distance());
}

void write_rows(std::span<const ContactRow> found, std::size_t first, ContactTable& contacts) {
    for (std::size_t i = 0; i < found.size(); ++i) write_contact(found[i], first + i, contacts);
}

/// Writes the contacts that the blocks have found, and the crossings from earlier attempts at this step. A crossing
/// replaces a contact with the same key.
void write_with_crossings(std::size_t blocks, PairTable& pairs, CrossingTable& crossings, ContactTable& contacts) {
    for (std::size_t b = blocks; b < pairs.found.size(); ++b) pairs.found[b].clear();
    merge_rows(pairs.found, crossings.row, false, crossings.merged);
    contacts.resize(crossings.merged.size());
    write_rows(crossings.merged.span(), 0, contacts);
}

}  // namespace

bool find_contacts(Executor& executor, const CollisionInputs& inputs, const CollisionSettings& settings, Real h,
                   PairTable& pairs, CrossingTable& crossings, ContactTable& contacts) {
    mark_idle(executor, inputs, pairs);
    const Index blocks = cut_blocks(executor, pairs);
    if (blocks == 0) {
        contacts.resize(0);
        return false;
    }
    pairs.block_nearest.resize(static_cast<std::size_t>(blocks));
    if (pairs.found.size() < static_cast<std::size_t>(blocks)) pairs.found.resize(static_cast<std::size_t>(blocks));
    if (pairs.near.size() < static_cast<std::size_t>(blocks)) pairs.near.resize(static_cast<std::size_t>(blocks));
    parallel_for(executor, static_cast<std::size_t>(blocks), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) test_block(inputs, settings, h, static_cast<Index>(b), pairs);
    });

    if (!crossings.row.empty()) {
        write_with_crossings(static_cast<std::size_t>(blocks), pairs, crossings, contacts);
        return true;
    }
    // Pairs are sorted by key, the candidates of a pair by feature, and each block is a range of the candidates in this
    // order. The contacts of all blocks, one after the other, are therefore in key order.
    pairs.block_first.resize(static_cast<std::size_t>(blocks));
    std::size_t count = 0;
    for (std::size_t b = 0; b < static_cast<std::size_t>(blocks); ++b) {
        pairs.block_first[b] = count;
        count += pairs.found[b].size();
    }
    contacts.resize(count);
    const auto write = [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) write_rows(pairs.found[b].span(), pairs.block_first[b], contacts);
    };
    parallel_for(executor, static_cast<std::size_t>(blocks),
                 count > contacts_per_block ? 1 : static_cast<std::size_t>(blocks), write);
    return true;
}

}  // namespace skerry
