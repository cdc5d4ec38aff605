// Contacts between a rigid cylinder and the bodies and colliders near it.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/cylinders/cylinder_row.h"

namespace skerry {

/// Version of look_at_candidates for a pair with a cylinder.
Real look_at_cylinder(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                      PairTable& pairs, Column<ContactRow>& found);

}  // namespace skerry
