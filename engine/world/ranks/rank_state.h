// Division of a world among ranks: the bodies that this rank owns, and copies of bodies of other ranks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "components/column.h"
#include "components/types.h"
#include "components/union_find.h"
#include "engine/world/ranks/hold/whole_world.h"
#include "engine/world/ranks/rank_findings.h"
#include "engine/world/ranks/regions/rank_mail.h"
#include "engine/world/step/balance.h"
#include "jobs/ranks/ranks.h"

namespace skerry {

/// Connection to the other ranks. Every stage that communicates declares that it writes RankChannel. The task graph
/// then runs these stages one after the other, in the same order on all ranks.
struct RankChannel {
    Ranks* ranks = nullptr;
};

/// Sums over the steps since the last call of join_records(), over the bodies and contacts that this rank computes.
/// join_records() adds them to the records of the run.
struct RankShare {
    Real dissipated = 0, plastic_work = 0;  // see RunCounters [J]
    Balance balance;                        // only its sums are used
    // Values of CrossingTable::tested, hits and let_through after the last call of join_records().
    std::uint64_t tested = 0, hits = 0, let_through = 0;
};

/// Predicted velocities (after forces, before contacts) of bodies with led ghosts: copies for which only the owner of
/// the body computes forces.
struct PredictionMail : RankMail {
    std::vector<MailReader> reader;  // by peer: reads `in`
};

/// Entry of the message about a set of touching bodies that one rank has found. The message has an entry for each body
/// of the set that several ranks hold.
struct SetMember {
    Index world_row;    // row of the body in the undivided world
    Index set;          // row of the first body of the set on the rank that has found the set
    Index stays_awake;  // nonzero if a body of the set must stay awake
};

/// Working memory of the stages that let bodies fall asleep or wake if several ranks hold them (sleep_over_ranks.cpp).
struct RankSleep {
    Column<std::uint8_t> asleep;  // by body
    Column<Real> still_time;      // by body [s]
    // bodies that this rank wakes and other ranks hold too: rows in the undivided world
    Column<Index> woken;
    Column<SetMember> members;  // entries for the sets that this rank has found
    // Nodes (elements) of the union-find `joined`, or no_index where there are none yet.
    // - `node_of_body`: for each row of the undivided world, the node that stands for the body.
    // - `node_of_set`: for each set in the message that is being read, the node that stands for the set.
    Column<Index> node_of_body, node_of_set;
    Column<std::uint8_t> restless;  // for each node of `joined`: 1 if its set must stay awake
    UnionFind joined;               // union of the sets that all ranks have found; sets with a common body are joined
};

/// A body that a rank must hold to solve a contact region.
struct BodyRequest {
    int rank;
    Index world_row;  // row of the body in the undivided world
};

/// Rounds in which ranks exchange the labels of their contact regions. The label of a region tells which rank solves it
/// (docs/methods/ranks.md 3).
struct LabelRounds {
    static constexpr int least = 2;
    int count = least;   // number of rounds in each attempt at a step, equal on all ranks
    int needed = least;  // greatest number of rounds that an attempt has needed since the last check
    int steps = 0;       // number of attempts since the last check

    /// Adjusts `count` to the number of rounds that an attempt has needed. If this number exceeds `count`, the labels
    /// had not settled, and the next attempt has one more round. After 500 attempts without such an increase, `count`
    /// falls to the greatest number that they needed.
    void note(int rounds) {
        constexpr int steps_between_checks = 500;
        if (rounds > count) {
            needed = ++count;
            steps = 0;
            return;
        }
        needed = std::max(needed, rounds);
        if (++steps < steps_between_checks) return;
        count = needed;
        needed = least;
        steps = 0;
    }
};

/// Row of BodyTable of the body that has the row `world_row` in the undivided world; no_index if this rank does not
/// hold it. `world_rows`: RankState::world_row.
inline Index local_row(std::span<const Index> world_rows, Index world_row) {
    const auto at = std::ranges::lower_bound(world_rows, world_row);
    return at != world_rows.end() && *at == world_row ? static_cast<Index>(at - world_rows.begin()) : no_index;
}

/// A rank *holds* the bodies that it owns and copies of bodies that other ranks own (*ghosts*). Each body has one
/// owner.
struct RankState {
    Ranks* ranks = nullptr;  // null: this process simulates the whole world
    int rank = 0;            // number of this rank
    std::vector<int> peers;  // ranks that hold a body that this rank holds too, ascending
    // For each row of BodyTable: rank that owns the body. Empty if `ranks` is null.
    Column<std::int32_t> owner;
    // For each row of BodyTable: the other ranks that hold the body, as indices in `peers`, ascending.
    std::vector<std::vector<int>> holders;
    // For each row of BodyTable: row of the body in the undivided world. These numbers ascend.
    Column<Index> world_row;
    // For each row of BodyTable: distance by which the body may move before its holders must be found again; infinite
    // for ghosts. `moved`: upper bound of the path of the body since its holders were found [m].
    Column<Real> margin, moved;
    Column<Real> tried_speed;  // by row of BodyTable: greatest speed in the last attempt at a step [m/s]
    WholeWorld whole;          // empty if `ranks` is null
    // For each row of the undivided world: number of pieces into which the stable-step checks of all bodies in earlier
    // rows are divided (count_pieces).
    Column<std::uint64_t> pieces_before;
    // For each row of BodyTable: 1 if this rank sends the predicted velocities of the body to its holders
    // (note_ghosts).
    Column<std::uint8_t> leads;
    RankChannel channel;
    PredictionMail predictions;
    RankSleep sleep;
    RankShare share;
    // keys (DisabledPairTable) of the pairs whose collisions were enabled because ties broke, as far as this rank knows
    Column<std::uint64_t> enabled_pairs;
    LabelRounds label_rounds;
    Column<BodyRequest> requests;  // bodies that other ranks need to solve regions, found in the last attempt
    Column<Index> stale;        // rows (of the undivided world) of own bodies whose copies on other ranks are outdated
    RankFindings own_findings;  // findings of this rank in this attempt at a step; complete when reduce_findings runs
    RankFindings all_findings;  // combined findings of all ranks in this attempt at a step
    bool stops = false;         // true if a callback of this rank has asked to end the present call of World::advance

    bool on() const { return ranks != nullptr; }
    bool owns(std::size_t body) const { return ranks == nullptr || owner[body] == rank; }
    Index world_row_of(Index row) const { return on() && row != no_index ? world_row[row] : row; }
    /// Row of BodyTable of the body in a row of the undivided world; no_index if this rank does not hold it.
    Index row_of(Index row_in_world) const { return on() ? local_row(world_row, row_in_world) : row_in_world; }
};

}  // namespace skerry
