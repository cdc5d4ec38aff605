// LU factorisation of a sparse matrix that consists of dense blocks of different sizes. The elimination order gives
// little fill-in. The pattern of blocks is symmetric, the entries need not be.
#pragma once

#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"
#include "systems/solver/equations/dense_factor.h"

namespace skerry {

/// A part is a group of unknowns. It has one row and one column of blocks. Memory is reused: if a problem of the same
/// size was solved earlier, no memory is allocated.
class BlockFactor {
public:
    /// Removes all parts.
    void start();
    /// Adds a part, which is a group of `size` unknowns. Returns the index of the part.
    Index add_part(Index size);
    /// Marks the blocks (g, h) and (h, g) as nonzero. Diagonal blocks always count as nonzero. Call it between
    /// close_parts() and analyse().
    void couple(Index g, Index h);
    void close_parts();
    /// Finds the elimination order. Returns false if the factor would need more than 256 MiB. After this result only
    /// start() may be called.
    bool analyse();
    /// Number of multiplications of one factorisation.
    Real work() const { return work_; }

    Index part_count() const { return static_cast<Index>(size_.size()); }
    Index size(Index g) const { return size_[static_cast<std::size_t>(g)]; }
    /// Entries of all blocks of the matrix. They are zero after analyse().
    Column<Real>& numbers() { return number_; }
    DenseBlock block(Index g, Index h);
    /// Right-hand side before solve(), solution after it. The entries of part g begin at first(g).
    Column<Real>& right() { return right_; }
    std::size_t first(Index g) const { return first_right_[static_cast<std::size_t>(g)]; }
    /// Sets right() = A x. `blocks` holds the entries of A in the layout of numbers().
    void multiply(std::span<const Real> blocks, std::span<const Real> x);
    /// Factors the matrix and solves for right(). The factor overwrites the blocks. Returns false if a pivot is zero or
    /// not finite.
    bool solve();

private:
    std::size_t pair(Index g, Index h) const {
        return static_cast<std::size_t>(g) * size_.size() + static_cast<std::size_t>(h);
    }
    DenseBlock right_of(Index g) { return {right_.data() + first(g), size(g), 1, size(g)}; }
    Index next_to_eliminate() const;
    void eliminate_pattern(Index next);
    void place_blocks();

    Column<Index> size_;  // by part: number of unknowns
    // For each pair of parts: 1 if the blocks that couple the two parts are nonzero, including fill-in.
    Column<std::uint8_t> coupled_;
    Column<Index> coupled_size_;  // by part: number of unknowns of the coupled parts that are not yet eliminated
    Column<Index> order_, rank_;  // order_: parts in elimination order; rank_: by part, its index in order_
    // For each entry k of order_: the parts that are coupled to part order_[k] and eliminated after this part.
    Ragged<Index> later_;
    Column<std::size_t> first_;   // by pair of parts: index of the block's first entry in `number_`
    Column<Index> stride_below_;  // by part: column stride of the part's blocks below the diagonal
    Column<std::size_t> first_right_;
    Column<Real> number_, right_;
    Column<Index> pivot_;
    Real work_ = 0;
};

}  // namespace skerry
