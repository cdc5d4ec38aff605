// Facts about all bodies of a world that is divided among ranks. All ranks have the same facts, except for the records.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/world/state/model.h"
#include "skerry/ranks.h"
#include "systems/collision/inputs/collision_inputs.h"
#include "systems/collision/inputs/contact_key.h"

namespace skerry {

/// A rank that holds copies of the bodies of a unit (set of bodies that joints or similar rows connect), because it has
/// to solve a contact region with one of them.
struct FetchedUnit {
    Index unit;  // WholeWorld::unit
    int rank;
    int searches;  // number of rank searches after which the rank no longer needs the unit
};

/// The *world row* of a body is its row in the undivided world. Bodies of a rank are in the order of these rows.
struct WholeWorld {
    // value of `owner` for a kinematic body, which every rank computes itself
    static constexpr std::int32_t everywhere = -1;

    // The next columns have one entry for each row of the undivided world.
    Column<std::int32_t> owner;  // rank
    Column<std::uint32_t> slot;  // BodyTable::slot
    // First row of the unit of the body in the undivided world. A *unit* is a set of bodies that joints, ties, cables,
    // springs and other rows connect. All bodies of a unit have the same owner and the same holders.
    Column<Index> unit;
    // records of bodies that this rank does not hold: complete on rank 0, only names on all other ranks
    std::vector<BodyRecord> records;
    std::vector<Index> world_row_of_slot;  // by handle slot: row of the body in the undivided world, or no_index
    // Rows, in the undivided world, of the table rows that connect bodies, such as joints. There is one list for each
    // table, in the order of Model::for_each_joining, and a last one for attachments. Each list is indexed by handle
    // slot.
    std::vector<std::vector<Index>> joining_world_row;
    // For each row of the undivided world: ranks that hold the body, ascending.
    std::vector<std::vector<int>> holders;
    std::vector<FetchedUnit> fetched;
    // number of steps of the run at the last rank search, which finds the bodies that each rank must hold
    std::uint64_t searched_step = 0;
    RankSettings settings;

    std::size_t size() const { return owner.size(); }
    Index row_of_slot(std::uint32_t slot_of_body) const { return world_row_of_slot[slot_of_body]; }
    /// The rank that searches the pair with this key (ContactKey::pair), and stores its contacts. `owners`: by row of
    /// the undivided world.
    std::int32_t pair_owner(std::uint64_t key, std::span<const std::int32_t> owners) const {
        const PairSlots pair = slots_of_pair(key);
        const bool of_first = pair.is_collider || !PairOwners::belongs_to_second(pair.first, pair.second);
        return owners[static_cast<std::size_t>(row_of_slot(of_first ? pair.first : pair.second))];
    }
    BodyHandle handle(const Model& model, Index world_row) const {
        return model.body_map.handle_of_slot(slot[world_row]);
    }
};

/// Facts about a world that is not yet divided. All bodies belong to rank 0.
WholeWorld whole_world_of(Model& model);

}  // namespace skerry
