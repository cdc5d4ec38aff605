// Selection of the candidates of a body and an analytic collider that are contacts of this step.
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/range.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Version of look_at_candidates for a pair with an analytic collider.
Real look_at_collider(const CollisionInputs& inputs, const CollisionSettings& settings, Real h, Index p, Range range,
                      PairTable& pairs, Column<ContactRow>& found);

}  // namespace skerry
