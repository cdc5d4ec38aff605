// Division of a world among ranks: the bodies that this rank owns, and copies of bodies of other ranks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "components/column.h"
#include "components/types.h"
#include "jobs/ranks/ranks.h"

namespace skerry {

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

    bool on() const { return ranks != nullptr; }
    bool owns(std::size_t body) const { return ranks == nullptr || owner[body] == rank; }
};

}  // namespace skerry
