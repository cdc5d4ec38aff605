// Who may touch whom: groups of bodies and colliders, and pairs that are switched off.
#pragma once

#include <cstdint>

#include "components/column.h"
#include "components/column_role.h"
#include "components/row_type.h"

namespace skerry {

/// Two collide if each is in a group that the mask of the other has.
struct CollisionFilter {
    std::uint32_t group = 1;           // a bit for every group that it is in
    std::uint32_t mask = 0xffffffffu;  // a bit for every group that it touches

    bool operator==(const CollisionFilter&) const = default;
};
template <>
struct NumbersOf<CollisionFilter> : SameNumbers<NumberType::uint32, 2> {};

inline bool may_touch(const CollisionFilter& a, const CollisionFilter& b) {
    return (a.group & b.mask) != 0 && (b.group & a.mask) != 0;
}

/// One row per pair that does not collide, whatever its groups; ascending.
struct DisabledPairTable {
    Column<std::uint64_t> key;  // ContactKey::pair

    void for_each_column(auto&& visit) { visit("key", key, ColumnRole::state); }
};

}  // namespace skerry
