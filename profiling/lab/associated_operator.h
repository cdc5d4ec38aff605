// Operator of contacts with general blocks under the associated law of friction (docs/methods/friction.md 1.4). Every
// contact minimises a convex energy over its cone. A sliding contact also lifts off at mu times its sliding speed.
#pragma once

#include <span>
#include <vector>

#include "profiling/lab/solve_convex_block.h"
#include "systems/solver/operators/block_operator.h"

namespace skerry::lab {

/// Operator of all contacts of a memory, in its order. It differs from BlockOperator in the solution of one contact, in
/// the projection and in the error. Methods that use `law` (automatic, newton) or `feasible` (conjugate gradients of
/// the paper) must not run on it: they would take the cone for Coulomb's.
class AssociatedOperator : public BlockOperator {
public:
    /// `memory` must have been prepared for these blocks in this order.
    AssociatedOperator(BlockMemory& memory, const BlockSystem& system, std::span<const Index> order);

    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    /// Relative error |r - P_K(r - u)| / max(|q|, |r|, |u|).
    Real error();
    bool suggests_check(Real, Real) const { return false; }  // only the schedule of the solver decides when to check
    Vec4 project(Index i, const Vec4& impulse) const;

private:
    Real step(Index i, Real relaxation);

    BlockMemory& memory_;
    std::vector<ConvexBlock> convex_;  // one per contact
};

}  // namespace skerry::lab
