// Features that a rigid cylinder would enter or pass through in this step.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/cylinders/cylinder_row.h"

namespace skerry {

/// Tests the candidates of a pair with a cylinder that can have met by `travel_bound` [m]. `known`: contacts that
/// earlier tries of the step have found, in key order. Returns the number of candidates tested.
std::uint64_t find_cylinder_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, std::span<const ContactRow> known,
                                      Column<ContactRow>& found);

}  // namespace skerry
