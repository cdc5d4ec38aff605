// Division of a world among ranks: the bodies that this rank owns, and copies of bodies of other ranks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "components/column.h"
#include "components/types.h"
#include "engine/world/ranks/rank_findings.h"
#include "jobs/ranks/ranks.h"

namespace skerry {

/// Connection to the other ranks. Every stage that calls a function of Ranks declares a write of it, so that the stages
/// call in the same order on all ranks.
struct RankChannel {
    Ranks* ranks = nullptr;
};

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
    // For each row of BodyTable: place of the body, its row in the undivided world. The places ascend.
    Column<Index> place;
    RankChannel channel;
    RankFindings mine;  // findings of this rank in this attempt at a step; complete when reduce_findings runs
    RankFindings all;   // combined findings of all ranks in this attempt at a step
    bool stops = false;  // true if a callback of this rank has asked to end the present call of World::advance

    bool on() const { return ranks != nullptr; }
    bool owns(std::size_t body) const { return ranks == nullptr || owner[body] == rank; }
    Index place_of(Index row) const { return on() && row != no_index ? place[row] : row; }
    /// Row of BodyTable of the body at a place of the undivided world; no_index if this rank does not hold it.
    Index row_of(Index of_place) const {
        if (!on()) return of_place;
        const auto at = std::ranges::lower_bound(place, of_place);
        return at != place.end() && *at == of_place ? static_cast<Index>(at - place.begin()) : no_index;
    }
};

}  // namespace skerry
