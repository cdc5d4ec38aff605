// Factor of a sparse matrix of dense blocks of different sizes, in an order with little fill-in. The pattern is
// symmetric, the numbers need not be.
#pragma once

#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"
#include "systems/solver/equations/dense_factor.h"

namespace skerry {

/// Memory is kept: solving a problem of a size seen before allocates nothing.
class BlockFactor {
public:
    /// Removes all parts.
    void start();
    /// Adds a row and a column of blocks with this many numbers. Returns its index.
    Index add_part(Index size);
    /// Marks the blocks of two parts as nonzero. Call it after close_parts().
    void couple(Index g, Index h);
    void close_parts();
    /// Finds the elimination order. Returns false if the factor needs too much memory; then call nothing else.
    bool analyse();
    /// Number of multiplications of a factorisation.
    Real work() const { return work_; }

    Index part_count() const { return static_cast<Index>(size_.size()); }
    Index size(Index g) const { return size_[static_cast<std::size_t>(g)]; }
    /// Numbers of all blocks; zero after analyse().
    Column<Real>& numbers() { return number_; }
    DenseBlock block(Index g, Index h);
    /// Right-hand side, then the solution. The numbers of a part begin at first().
    Column<Real>& right() { return right_; }
    std::size_t first(Index g) const { return first_right_[static_cast<std::size_t>(g)]; }
    /// Sets right() = A x, where `blocks` holds the numbers of A in the layout of numbers().
    void multiply(std::span<const Real> blocks, std::span<const Real> x);
    /// Factors and solves in place: the factor overwrites the blocks. Returns false if a pivot breaks down.
    bool solve();

private:
    std::size_t pair(Index g, Index h) const {
        return static_cast<std::size_t>(g) * size_.size() + static_cast<std::size_t>(h);
    }
    DenseBlock right_of(Index g) { return {right_.data() + first(g), size(g), 1, size(g)}; }
    Index next_to_eliminate() const;
    void eliminate_pattern(Index next);
    void place_blocks();

    Column<Index> size_;            // by part
    Column<std::uint8_t> coupled_;  // by pair of parts, including fill-in
    Column<Index> beside_;          // by part: total size of the coupled parts that are not eliminated
    Column<Index> order_, rank_;    // elimination order, and the place of each part in it
    Ragged<Index> later_;           // by place in the order: parts that the elimination changes
    Column<std::size_t> first_;     // by pair of parts: index in `number_`
    Column<Index> stride_below_;    // by part: stride of its blocks below the diagonal
    Column<std::size_t> first_right_;
    Column<Real> number_, right_;
    Column<Index> pivot_;
    Real work_ = 0;
};

}  // namespace skerry
