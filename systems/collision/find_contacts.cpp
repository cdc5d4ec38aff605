#include "systems/collision/find_contacts.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "jobs/parallel_for.h"
#include "systems/collision/contact_rows.h"
#include "systems/collision/cylinders/cylinder_row.h"
#include "systems/collision/look_at_awake.h"
#include "systems/collision/look_at_candidates.h"

namespace skerry {

namespace {

// Candidates of one block, asleep or not; a pair counts as some more. Asleep it takes a microsecond, awake a hundred.
constexpr Index candidates_per_block = 2048;
constexpr Index candidates_worth_of_a_pair = 16;

constexpr std::size_t rows_per_block = 256;
constexpr Index pairs_ahead = 3;                      // lists are asked for, before they are looked at
constexpr std::size_t counted_pairs_per_block = 512;  // of which it is looked up what is to be looked at

bool collider_stands_still(const CollisionInputs& inputs, Index collider) {
    return inputs.collider.motion[collider].stands_still();
}

bool body_stands_still(const CollisionInputs& inputs, Index body) {
    if (inputs.body.kind[body] == BodyKind::kinematic) return collider_stands_still(inputs, inputs.body.collider[body]);
    return inputs.body.asleep[body] != 0;
}

/// Pairs of which neither partner moves: what is between them is in equilibrium, or they would not rest. Of the others,
/// how many candidates they have.
void mark_idle(Executor& executor, const CollisionInputs& inputs, PairTable& pairs) {
    pairs.idle.resize(pairs.size());
    pairs.looked_at.resize(pairs.size());
    parallel_for(executor, pairs.size(), counted_pairs_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            pairs.idle[p] = inputs.body.asleep[pairs.first[p]] &&
                            (pairs.kind[p] == PairKind::collider ? collider_stands_still(inputs, pairs.second[p])
                                                                 : body_stands_still(inputs, pairs.second[p]));
            pairs.looked_at[p] = pairs.idle[p] ? 0 : static_cast<Index>(pairs.candidates[p].size());
        }
    });
}

/// Cuts the concatenated candidate lists of the pairs that do not rest into blocks of about equal length. Returns their
/// number.
Index cut_blocks(PairTable& pairs) {
    pairs.block.clear();
    Index filled = candidates_per_block;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const Index count = pairs.looked_at[p];
        if (filled < candidates_per_block && filled + count <= candidates_per_block) {  // most pairs: nothing to cut
            filled += count > 0 ? count + candidates_worth_of_a_pair : 0;
            continue;
        }
        for (Index begin = 0; begin < count;) {
            if (filled >= candidates_per_block) {
                pairs.block.push_back({static_cast<Index>(p), begin});
                filled = 0;
            }
            const Index take = std::min(count - begin, candidates_per_block - filled);
            begin += take;
            filled += take + candidates_worth_of_a_pair;
        }
    }
    const Index blocks = static_cast<Index>(pairs.block.size());
    pairs.block.push_back({static_cast<Index>(pairs.size()), 0});
    return blocks;
}

/// Has the beginning of a pair's list fetched, the rest follows by itself: each lies elsewhere, and waiting for them
/// was a good part of the stage.
void ask_for_list(const PairTable& pairs, Index p) {
    constexpr std::size_t begin = 256, line = 64;  // bytes
    if (p >= static_cast<Index>(pairs.size())) return;
    const auto* const list = reinterpret_cast<const std::byte*>(pairs.asleep_until[p].data());
    for (std::size_t i = 0; i < begin; i += line) __builtin_prefetch(list + i);
}

/// Whether features of two surfaces are held against each other, as they are of most pairs.
bool is_of_surfaces(const CollisionInputs& inputs, const PairTable& pairs, Index p) {
    return pairs.kind[p] != PairKind::collider && !has_cylinder(inputs, pairs, p);
}

void look_at_block(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index b,
                   PairTable& pairs) {
    const CandidatePlace begin = pairs.block[b], end = pairs.block[b + 1];
    Column<ContactRow>& found = pairs.found[b];
    Column<NearCandidate>& near = pairs.near[b];
    found.clear();
    near.clear();
    Real nearest = std::numeric_limits<Real>::infinity();
    AwakeCandidates awake(inputs, settings, h, pairs, found, near);
    for (Index p = begin.pair; p < static_cast<Index>(pairs.size()) && p <= end.pair; ++p) {
        const Index from = p == begin.pair ? begin.candidate : 0;
        const Index to = p == end.pair ? end.candidate : static_cast<Index>(pairs.candidates[p].size());
        ask_for_list(pairs, p + pairs_ahead);
        if (from >= to || pairs.idle[p]) continue;
        if (settings.use_budgets && is_of_surfaces(inputs, pairs, p)) {
            awake.add(p, {from, to});
            continue;
        }
        awake.look();  // contacts are in the order of their pairs
        nearest = std::min(nearest, look_at_candidates(inputs, settings, h, p, {from, to}, pairs, found));
    }
    awake.look();
    pairs.block_nearest[b] = std::min(nearest, awake.least_distance());
}

void write_rows(std::span<const ContactRow> found, std::size_t first, ContactTable& contacts) {
    for (std::size_t i = 0; i < found.size(); ++i) {
        const ContactRow& row = found[i];
        const std::size_t c = first + i;
        contacts.key[c] = row.key;
        contacts.kind[c] = row.kind;
        contacts.stencil[c] = row.stencil;
        contacts.point[c] = row.point;
        contacts.normal[c] = row.normal;
        contacts.gap[c] = row.gap;
        contacts.distance[c] = row.distance;
        contacts.surface_velocity[c] = row.surface_velocity;
        contacts.static_friction[c] = row.static_friction;
        contacts.dynamic_friction[c] = row.dynamic_friction;
        contacts.restitution[c] = row.restitution;
        contacts.first_body[c] = row.first_body;
        contacts.second_body[c] = row.second_body;
        contacts.collider[c] = row.collider;
        contacts.impulse[c] = Vec3::Zero();
        contacts.region[c] = no_index;
        contacts.slip[c] = Vec3::Zero();
        contacts.state[c] = ContactState::open;
    }
}

/// Crossings take the place of what was found of the same features.
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
    const Index blocks = cut_blocks(pairs);
    if (blocks == 0) {
        contacts.resize(0);
        return false;
    }
    pairs.block_nearest.resize(static_cast<std::size_t>(blocks));
    if (pairs.found.size() < static_cast<std::size_t>(blocks)) pairs.found.resize(static_cast<std::size_t>(blocks));
    if (pairs.near.size() < static_cast<std::size_t>(blocks)) pairs.near.resize(static_cast<std::size_t>(blocks));
    parallel_for(executor, static_cast<std::size_t>(blocks), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) look_at_block(inputs, settings, h, static_cast<Index>(b), pairs);
    });

    if (!crossings.row.empty()) {
        write_with_crossings(static_cast<std::size_t>(blocks), pairs, crossings, contacts);
        return true;
    }
    // Pairs are in key order, candidates in feature order, blocks in both: so are the contacts.
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
                 count > rows_per_block ? 1 : static_cast<std::size_t>(blocks), write);
    return true;
}

}  // namespace skerry
