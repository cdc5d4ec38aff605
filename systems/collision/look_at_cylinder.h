// A rigid cylinder against what is near it.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/cylinders/cylinder_row.h"

namespace skerry {

/// As look_at_candidates, of a pair with a cylinder.
Real look_at_cylinder(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                      PairTable& pairs, Column<ContactRow>& found);

}  // namespace skerry
