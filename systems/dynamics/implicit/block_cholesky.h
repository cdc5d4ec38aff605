// Cholesky factorisation of sparse symmetric matrices of 3x3 blocks. Each block couples two nodes; nodes that share no
// element have no block (docs/methods/implicit_bodies.md 3).
#pragma once

#include <span>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Lower triangle of a symmetric matrix of 3x3 blocks, stored row by row. The columns of a row ascend, so the last
/// block of each row is the diagonal block.
struct BlockRows {
    std::vector<Index> offset{0};  // index of the first block of each row; rows + 1 entries
    std::vector<Index> column;
    std::vector<Mat3> block;

    std::size_t size() const { return offset.size() - 1; }
    /// Computes the product out = A x of this matrix A and a vector x.
    void multiply(std::span<const Vec3> x, std::span<Vec3> out) const;
};

/// Returns the index of each node in an elimination order. The order is chosen by minimum degree, so that the Cholesky
/// factor has few nonzero blocks. `neighbours`: for each node, all other nodes that a block of the matrix couples to
/// it; each pair of nodes occurs in both lists.
std::vector<Index> elimination_order(const std::vector<std::vector<Index>>& neighbours);

/// Cholesky factorisation L L^T of a matrix A, row by row (up-looking: Davis, Direct Methods for Sparse Linear Systems,
/// 2006, 4.7). The sparsity pattern is analysed once. Factoring other matrices with the same pattern allocates nothing.
class BlockCholesky {
public:
    BlockCholesky() = default;
    explicit BlockCholesky(const BlockRows& pattern);

    /// Factors a matrix. Returns false if the matrix is not positive definite; the factor is then unusable.
    bool factor(const BlockRows& matrix);
    /// Replaces x by A^-1 x, with the factored matrix A.
    void solve(std::span<Vec3> x) const { solve_in_place(x.data()); }
    /// Replaces three right-hand sides x by A^-1 x at once, with the factored matrix A.
    void solve(std::span<Mat3> x) const { solve_in_place(x.data()); }

private:
    template <class X>
    void solve_in_place(X* x) const;
    /// Columns of the nonzero blocks in row `k` of L, left of the diagonal, in the order in which these blocks are
    /// computed. Each block comes after all blocks of the row from which its value is computed. Sets mark_ to k for
    /// these columns and for column k.
    std::span<const Index> columns_of(const BlockRows& pattern, Index k);

    std::vector<Index> parent_;           // parent of each column in the elimination tree; no_index for a root
    std::vector<std::size_t> first_;      // start of each column in row_ and block_; columns + 1 entries
    std::vector<Index> row_;              // row of each block of L below the diagonal
    std::vector<Mat3> block_;             // L_ij
    std::vector<Mat3> inverse_diagonal_;  // inverses of the diagonal blocks of L (lower triangular)
    // Work memory for one row k. `mark_`: by column, the last row in which columns_of() found the column; `path_`: path
    // in the elimination tree; `stack_`: columns of the row, filled from its end.
    std::vector<Index> mark_, path_, stack_;
    std::vector<std::size_t> end_;  // by column: index after its last block that is computed so far
    std::vector<Mat3> sum_;
};

}  // namespace skerry
