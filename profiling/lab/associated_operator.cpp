#include "profiling/lab/associated_operator.h"

#include <algorithm>
#include <cmath>

namespace skerry::lab {

static_assert(ContactOperator<AssociatedOperator>);

AssociatedOperator::AssociatedOperator(BlockMemory& memory, const BlockSystem& system, std::span<const Index> order)
    : BlockOperator(memory, 0, static_cast<Index>(order.size()), Friction::cone, 0), memory_(memory) {
    for (const Index row : order)
        for (Index k = system.row_offset[row]; k < system.row_offset[row + 1]; ++k)
            if (system.column[k] == row) convex_.push_back(prepare_convex_block(system.block[k], system.mu[row]));
}

Vec4 AssociatedOperator::project(Index i, const Vec4& impulse) const {
    return project_onto_cone(impulse, normal(i), memory_.contact[i].mu);
}

Real AssociatedOperator::step(Index i, Real relaxation) {
    const BlockMemory::Contact& contact = memory_.contact[i];
    const Vec4 before = memory_.impulse[i];
    Vec4 fixed = contact.q + times(contact.skew, before);
    for (Index k = memory_.offset[i]; k < memory_.offset[i + 1]; ++k)
        fixed += times(memory_.block[k], memory_.impulse[memory_.neighbor[k]]);
    Vec4 next = padded(solve_convex_block(convex_[i], fixed.head<3>(), contact.mu));
    if (relaxation != 1) next = project(i, before + relaxation * (next - before));
    memory_.impulse[i] = next;
    return inner(i, next - before, next - before);
}

Real AssociatedOperator::sweep(Real relaxation) {
    Real change = 0;
    for (Index i = 0; i < size(); ++i) change += step(i, relaxation);
    return change;
}

SweepChange AssociatedOperator::accelerated_sweep(Real relaxation) {
    const std::span<const Vec4> present = impulse(), previous = workspace(1);
    SweepChange sum;
    for (Index i = 0; i < size(); ++i) {
        const Vec4 before = present[i];
        sum.squared_change += step(i, relaxation);
        sum.reversal -= inner(i, present[i] - before, present[i] - previous[i]);
    }
    return sum;
}

Real AssociatedOperator::error() {
    std::vector<Vec4> pull(memory_.impulse.size());  // -u
    residual(pull);
    Real lack = 0, q = 0, r = 0, u = 0;
    for (Index i = 0; i < size(); ++i) {
        const Vec4& impulse = memory_.impulse[i];
        lack += (impulse - project(i, impulse + pull[i])).squaredNorm();
        q += memory_.contact[i].q.squaredNorm();
        r += impulse.squaredNorm();
        u += pull[i].squaredNorm();
    }
    return lack == 0 ? 0 : std::sqrt(lack / std::max({q, r, u}));
}

}  // namespace skerry::lab
