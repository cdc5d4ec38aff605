// Dense matrices in memory of the caller: factors, solutions and products that allocate nothing, for blocks of a sparse
// factor (body_equations.h). Columns one after the other, `stride` numbers apart. Sums are in the order of their
// index, so that bits do not depend on the width of registers.
#pragma once

#include <cstddef>

#include "components/types.h"

namespace skerry {

struct DenseBlock {
    Real* data;
    Index rows, columns;
    std::ptrdiff_t stride;

    Real* column(Index k) const { return data + k * stride; }
    DenseBlock part(Index row, Index column, Index row_count, Index column_count) const {
        return {data + row + column * stride, row_count, column_count, stride};
    }
};

/// c -= a b.
void subtract_product(const DenseBlock& a, const DenseBlock& b, const DenseBlock& c);
/// y += a x, where `numbers` are those of a, placed as in `shape`.
void add_product(const DenseBlock& shape, const Real* numbers, const Real* x, Real* y);
/// a = L U with rows exchanged: `pivot[k]` is the row that came to k. Returns false where a is singular.
bool factor_dense(const DenseBlock& a, Index* pivot);
/// b = a^-1 b, of the factors.
void solve_dense(const DenseBlock& factors, const Index* pivot, const DenseBlock& b);

}  // namespace skerry
