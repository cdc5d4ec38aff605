// What a rigid cylinder would come into or through in this step.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/cylinders/cylinder_row.h"

namespace skerry {

/// Looks at the candidates of a pair with a cylinder that can have met by `travel_bound`. `known`: what earlier
/// tries of the step have found, in the order of keys. Returns how many were tested.
std::uint64_t find_cylinder_crossings(const CollisionInputs& inputs, const StepMotion& motion, const PairTable& pairs,
                                      Index p, Range range, Real travel_bound, std::span<const ContactRow> known,
                                      Column<ContactRow>& found);

}  // namespace skerry
