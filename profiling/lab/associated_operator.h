// Contacts of general blocks under the associated law (docs/methods/friction.md 1.4): every contact minimises a convex
// energy over its cone, and contacts that slide also lift off at mu times their speed.
#pragma once

#include <span>
#include <vector>

#include "profiling/lab/solve_convex_block.h"
#include "systems/solver/operators/block_operator.h"

namespace skerry::lab {

/// All contacts of a memory, in its order. Differs from BlockOperator in the solution of one contact, in the projection
/// and in the error. Not for methods that ask for `law` (automatic, newton) or for `feasible` (conjugate gradients of
/// the paper): they would take it for Coulomb's cone.
class AssociatedOperator : public BlockOperator {
public:
    /// `memory` is prepared for these blocks in this order.
    AssociatedOperator(BlockMemory& memory, const BlockSystem& system, std::span<const Index> order);

    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    /// |r - P_K(r - u)| / max(|q|, |r|, |u|).
    Real error();
    bool suggests_check(Real, Real) const { return false; }  // the schedule decides alone
    Vec4 project(Index i, const Vec4& impulse) const;

private:
    Real step(Index i, Real relaxation);

    BlockMemory& memory_;
    std::vector<ConvexBlock> convex_;  // by contact
};

}  // namespace skerry::lab
