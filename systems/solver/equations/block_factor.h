// The factor of a sparse matrix of dense blocks of different sizes, in an order that fills in little. Symmetric in its
// pattern, not in its numbers.
#pragma once

#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"
#include "systems/solver/equations/dense_factor.h"

namespace skerry {

/// Keeps its memory: what has been solved once allocates nothing again.
class BlockFactor {
public:
    /// No parts yet.
    void start();
    /// A row and a column of blocks with this many numbers. Returns its place.
    Index add_part(Index size);
    /// Two parts that have blocks. Not before all parts are added.
    void couple(Index g, Index h);
    void close_parts();
    /// Finds the order. False where the factor would take more memory than is sensible: then nothing else may be asked.
    bool analyse();
    /// Multiplications of a factorisation.
    Real work() const { return work_; }

    Index part_count() const { return static_cast<Index>(size_.size()); }
    Index size(Index g) const { return size_[static_cast<std::size_t>(g)]; }
    /// All blocks, zero after analyse().
    Column<Real>& numbers() { return number_; }
    DenseBlock block(Index g, Index h);
    /// The right-hand side, then the solution; a part has its numbers from first() on.
    Column<Real>& right() { return right_; }
    std::size_t first(Index g) const { return first_right_[static_cast<std::size_t>(g)]; }
    /// right() = blocks x, with blocks as numbers() has them.
    void multiply(std::span<const Real> blocks, std::span<const Real> x);
    /// False where a pivot breaks down. The factor takes the place of the blocks.
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
    Column<std::uint8_t> coupled_;  // by pair of parts, with what is filled in
    Column<Index> beside_;          // by part: numbers of those coupled to it that are not eliminated
    Column<Index> order_, rank_;    // of elimination, and by part the place in it
    Ragged<Index> later_;           // by place in the order: those that the elimination of the part changes
    Column<std::size_t> first_;     // by pair of parts, in `number_`
    Column<Index> stride_below_;    // by part, of its blocks below the diagonal
    Column<std::size_t> first_right_;
    Column<Real> number_, right_;
    Column<Index> pivot_;
    Real work_ = 0;
};

}  // namespace skerry
