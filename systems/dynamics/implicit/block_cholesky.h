// Cholesky factors of sparse symmetric matrices of 3x3 blocks, one a pair of nodes (docs/methods/implicit_bodies.md 3).
#pragma once

#include <span>
#include <vector>

#include "components/types.h"

namespace skerry {

/// The lower triangle of a symmetric matrix, row by row, columns ascending: the diagonal comes last in each.
struct BlockRows {
    std::vector<Index> offset{0};  // rows + 1
    std::vector<Index> column;
    std::vector<Mat3> block;

    std::size_t size() const { return offset.size() - 1; }
    /// out = matrix x.
    void multiply(std::span<const Vec3> x, std::span<Vec3> out) const;
};

/// The places of nodes in an order of elimination that fills in little (minimum degree). `neighbours`: by node, others
/// that it shares blocks with, each in both lists.
std::vector<Index> elimination_places(const std::vector<std::vector<Index>>& neighbours);

/// L L^T = matrix, row after row (up-looking: Davis, Direct Methods for Sparse Linear Systems, 2006, 4.7). What the
/// pattern needs is found once; factors of other matrices of that pattern allocate nothing.
class BlockCholesky {
public:
    BlockCholesky() = default;
    explicit BlockCholesky(const BlockRows& pattern);

    /// False, and of no use, where the matrix is not positive definite.
    bool factor(const BlockRows& matrix);
    /// x = matrix^-1 x.
    void solve(std::span<Vec3> x) const { solve_in_place(x.data()); }
    /// The same for three columns at once.
    void solve(std::span<Mat3> x) const { solve_in_place(x.data()); }

private:
    template <class X>
    void solve_in_place(X* x) const;
    /// The columns of L that row `k` has, each after those it needs. Marks them by k.
    std::span<const Index> columns_of(const BlockRows& pattern, Index k);

    std::vector<Index> parent_;           // of the elimination tree, by column; no_index: none
    std::vector<std::size_t> first_;      // of each column in row_ and block_; columns + 1
    std::vector<Index> row_;              // below the diagonal
    std::vector<Mat3> block_;             // L_ij
    std::vector<Mat3> inverse_diagonal_;  // lower triangles
    // of one row at a time
    std::vector<Index> mark_, path_, stack_;
    std::vector<std::size_t> end_;  // of what a column has so far
    std::vector<Mat3> sum_;
};

}  // namespace skerry
