// Dense LU factorisation, solution and products of matrices, without allocation, for the blocks of a sparse factor
// (block_factor.h). Matrices are stored by columns, which begin `stride` numbers apart. Sums are taken in index order,
// so that the bits do not depend on the width of registers.
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

/// Subtracts a product of matrices: c -= a b.
void subtract_product(const DenseBlock& a, const DenseBlock& b, const DenseBlock& c);
/// Adds a matrix times a vector: y += a x. `shape` gives the size and layout of the matrix a, `numbers` its entries.
void add_product(const DenseBlock& shape, const Real* numbers, const Real* x, Real* y);
/// Factors a = L U with row exchanges: for k = 0, 1, ..., row k is exchanged with row `pivot[k]`. L and U overwrite a.
/// Returns false if a pivot is zero or not finite.
bool factor_dense(const DenseBlock& a, Index* pivot);
/// Solves a x = b with the factors from factor_dense. The solution overwrites b.
void solve_dense(const DenseBlock& factors, const Index* pivot, const DenseBlock& b);

}  // namespace skerry
