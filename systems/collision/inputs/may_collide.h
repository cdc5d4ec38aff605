// Test for whether the two partners of a pair may collide, by their collision filters and by the list of disabled
// pairs.
#pragma once

#include <algorithm>
#include <span>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/collision_filter.h"
#include "components/pair_table.h"
#include "systems/collision/inputs/contact_key.h"

namespace skerry {

/// Key of a pair (ContactKey::pair). `first`: row in BodyTable of a body that is not kinematic. `second`: row of
/// BodyTable, or of ColliderTable if `kind` is collider.
inline std::uint64_t pair_key(const BodyTable& body, const ColliderTable& collider, PairKind kind, Index first,
                              Index second) {
    if (kind == PairKind::collider) return collider_pair_key(body.slot[first], collider.slot[second]);
    if (body.kind[second] == BodyKind::kinematic) return collider_pair_key(body.slot[first], body.slot[second]);
    return body_pair_key(std::min(body.slot[first], body.slot[second]), std::max(body.slot[first], body.slot[second]));
}

/// True if the collision filters of both partners permit a contact and the pair is not disabled. `disabled`: keys of
/// DisabledPairTable. For a body paired with itself the result is always true, because the pair exists only if
/// BodyTable::self_contact is set.
inline bool may_collide(const BodyTable& body, const ColliderTable& collider, std::span<const std::uint64_t> disabled,
                        PairKind kind, Index first, Index second) {
    if (kind == PairKind::self) return true;
    const bool is_collider = kind == PairKind::collider || body.kind[second] == BodyKind::kinematic;
    const Index row = kind == PairKind::collider ? second : body.collider[second];
    const CollisionFilter& other = is_collider ? collider.filter[row] : body.filter[second];
    if (!may_touch(body.filter[first], other)) return false;
    return disabled.empty() ||
           !std::binary_search(disabled.begin(), disabled.end(), pair_key(body, collider, kind, first, second));
}

}  // namespace skerry
