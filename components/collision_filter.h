// Collision filters: groups of bodies and colliders, and pairs whose collisions are switched off.
#pragma once

#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/row_type.h"

namespace skerry {

/// Two objects collide if each of them belongs to a group in the mask of the other.
struct CollisionFilter {
    std::uint32_t group = 1;           // one bit per group that the object belongs to
    std::uint32_t mask = 0xffffffffu;  // one bit per group that the object collides with

    bool operator==(const CollisionFilter&) const = default;
};
template <>
struct NumbersOf<CollisionFilter> : SameNumbers<NumberType::uint32, 2> {};

inline bool may_touch(const CollisionFilter& a, const CollisionFilter& b) {
    return (a.group & b.mask) != 0 && (b.group & a.mask) != 0;
}

/// One row per pair of objects that never collide, whatever their groups. Rows are sorted by ascending key.
struct DisabledPairTable {
    Column<std::uint64_t> key;  // ContactKey::pair

    void for_each_column(auto&& visit) { visit("key", key, ColumnRole::state); }
};

}  // namespace skerry
