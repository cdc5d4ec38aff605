// Handles: numbers by which the user of the library refers to bodies, colliders, materials, joints and other objects.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"

namespace skerry {

/// Refers to one row of a table as long as the row exists. A handle to a removed row is recognised as stale, even if
/// its slot has been reused. A handle to a row of another world is recognised as foreign.
template <class Tag>
struct Handle {
    std::uint32_t slot = 0xffffffffu;  // entry of HandleMap that stores the row; later handles may reuse the entry
    std::uint32_t generation = 0;      // grows each time the slot is reused, so that older handles become stale
    std::uint32_t world = 0;           // number of the world; a copy of a world has the number of the original

    auto operator<=>(const Handle&) const = default;
};

using MaterialHandle = Handle<struct MaterialTag>;      // refers to a material of a world
using BodyHandle = Handle<struct BodyTag>;              // refers to a deformable or rigid body
using ColliderHandle = Handle<struct ColliderTag>;      // refers to a collider, which no force moves
using AttachmentHandle = Handle<struct AttachmentTag>;  // refers to nodes with a prescribed motion
using FibreHandle = Handle<struct FibreTag>;            // refers to a family of fibres in a body

/// Maps handles to rows of a table. When rows are erased, later rows get lower indices. Their handles stay valid,
/// because rows_moved() updates the map.
template <class HandleType>
class HandleMap {
public:
    /// Number of the world that owns the rows. A copy of a world, and a world that was saved and loaded, has the number
    /// of the original, so that earlier handles stay valid. The number has no effect on the results of steps.
    std::uint32_t world() const { return world_; }
    /// Sets the number of the world.
    void set_world(std::uint32_t number) { world_ = number; }

    /// Makes a handle for the new row `row`. The lowest free slot is used, so that the same sequence of calls returns
    /// the same handles.
    HandleType insert(Index row) {
        std::uint32_t slot = lowest_free_;
        while (slot < row_.size() && row_[slot] != no_index) ++slot;
        if (slot == row_.size()) {
            row_.push_back(no_index);
            generation_.push_back(least_generation_);
        }
        row_[slot] = row;
        lowest_free_ = slot + 1;
        return handle_of_slot(slot);
    }

    /// The row of a live handle; no_index for a stale handle and for a handle of another world.
    Index row(HandleType handle) const {
        if (handle.world != world_ || handle.slot >= row_.size() || generation_[handle.slot] != handle.generation)
            return no_index;
        return row_[handle.slot];
    }

    /// Makes a live handle refer to the row `row`.
    void rename(HandleType handle, Index row) { row_[handle.slot] = row; }

    /// Releases a live handle. The row stays in the table, but no handle refers to it.
    void forget(HandleType handle) {
        row_[handle.slot] = no_index;
        generation_[handle.slot] = std::max(generation_[handle.slot] + 1, least_generation_);
        if (handle.slot < lowest_free_) lowest_free_ = handle.slot;
    }

    /// Prepares this map to replace `other`, a map of the same world (World::reset). No handle made from now on equals
    /// a handle that `other` has issued. Handles of `other` that are stale in this map thus stay stale.
    void differ_from(const HandleMap& other) {
        least_generation_ = std::max(least_generation_, other.least_generation_);
        for (std::size_t slot = 0; slot < other.row_.size(); ++slot)
            least_generation_ = std::max(least_generation_, other.generation_[slot] + (other.row_[slot] != no_index));
        for (std::size_t slot = 0; slot < row_.size(); ++slot)
            if (row_[slot] == no_index) generation_[slot] = std::max(generation_[slot], least_generation_);
    }
    /// Lower limit of the generation of every new handle; differ_from() raises it. It is saved with the columns.
    std::uint32_t& least_generation() { return least_generation_; }

    /// Updates all live handles after rows of the table were removed. The handles of the removed rows must already have
    /// been released by forget(). `row_now`: new index of each old row, no_index for removed rows.
    void rows_moved(std::span<const Index> row_now) {
        for (Index& row : row_)
            if (row != no_index) row = row_now[static_cast<std::size_t>(row)];
    }

    bool has_slot(std::uint32_t slot) const { return slot < row_.size() && row_[slot] != no_index; }
    /// The live handle with this slot number. A row of a table stores only the slot number of its handle.
    HandleType handle_of_slot(std::uint32_t slot) const { return {slot, generation_[slot], world_}; }

    void for_each_column(auto&& visit) {
        visit("row", row_);
        visit("generation", generation_);
    }

private:
    Column<Index> row_;  // by slot: row of the handle; no_index for a free slot
    Column<std::uint32_t> generation_;
    std::uint32_t world_ = 0;
    std::uint32_t least_generation_ = 0;
    std::uint32_t lowest_free_ = 0;  // all slots below this one are in use
};

}  // namespace skerry
