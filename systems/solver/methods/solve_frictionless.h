// A region without friction: one row a contact (methods.md 7).
#pragma once

#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// Normal impulses, by contact, N s.
struct FrictionlessMemory {
    std::span<Real> impulse, previous;
};

/// solve_ags on the normal impulses alone: the same iteration, with a third of the data and no projection onto a cone. Starts from and
/// leaves region.impulse, which must be along the normals.
SolveResult solve_frictionless(const LumpedOperator::Memory& region, Real scale, const SolveLimits& limits,
                               const FrictionlessMemory& memory);

}  // namespace skerry
