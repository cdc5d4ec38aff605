// Cholesky factorisation of sparse symmetric matrices of 3x3 blocks, one block for each pair of nodes
// (docs/methods/implicit_bodies.md 3).
#pragma once

#include <span>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Lower triangle of a symmetric matrix of 3x3 blocks, row by row with ascending columns. The diagonal block is the
/// last of each row.
struct BlockRows {
    std::vector<Index> offset{0};  // start of each row; rows + 1 entries
    std::vector<Index> column;
    std::vector<Mat3> block;

    std::size_t size() const { return offset.size() - 1; }
    /// out = matrix x.
    void multiply(std::span<const Vec3> x, std::span<Vec3> out) const;
};

/// Place of each node in an elimination order with little fill-in (minimum degree). `neighbours`: for each node the
/// others that share blocks with it; each pair is in both lists.
std::vector<Index> elimination_places(const std::vector<std::vector<Index>>& neighbours);

/// Factorisation L L^T = matrix, row by row (up-looking: Davis, Direct Methods for Sparse Linear Systems, 2006, 4.7).
/// The pattern is analysed once. Factoring other matrices of that pattern allocates nothing.
class BlockCholesky {
public:
    BlockCholesky() = default;
    explicit BlockCholesky(const BlockRows& pattern);

    /// Returns false if the matrix is not positive definite; the factor is then unusable.
    bool factor(const BlockRows& matrix);
    /// x = matrix^-1 x.
    void solve(std::span<Vec3> x) const { solve_in_place(x.data()); }
    /// x = matrix^-1 x for three right-hand sides at once.
    void solve(std::span<Mat3> x) const { solve_in_place(x.data()); }

private:
    template <class X>
    void solve_in_place(X* x) const;
    /// Columns of the nonzero blocks in row `k` of L, each after those it depends on. Marks them by k.
    std::span<const Index> columns_of(const BlockRows& pattern, Index k);

    std::vector<Index> parent_;           // parent of each column in the elimination tree; no_index: none
    std::vector<std::size_t> first_;      // start of each column in row_ and block_; columns + 1 entries
    std::vector<Index> row_;              // row of each block below the diagonal
    std::vector<Mat3> block_;             // L_ij
    std::vector<Mat3> inverse_diagonal_;  // inverses of the diagonal blocks of L, lower triangles
    // Work memory for one row at a time:
    std::vector<Index> mark_, path_, stack_;
    std::vector<std::size_t> end_;  // end of the blocks of each column that are known so far
    std::vector<Mat3> sum_;
};

}  // namespace skerry
