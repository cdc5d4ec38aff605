// Reductions (sums, extremes) over rows that give the same bits on any number of workers.
#pragma once

#include <type_traits>

#include "components/column.h"
#include "jobs/parallel_for.h"

namespace skerry {

/// Returns combine(... combine(combine(identity, block 0), block 1) ..., last block), where block b is the result of
/// block_result(begin, end) for at most `block` rows. Blocks run concurrently. Their results are combined in block
/// order, because floating-point addition depends on the order. `partial` holds the results of the blocks and keeps its
/// memory between calls.
template <class T, class BlockResult, class Combine>
T reduce(Executor& executor, std::size_t count, std::size_t block, Column<T>& partial,
         const std::type_identity_t<T>& identity, BlockResult&& block_result, Combine&& combine) {
    const std::size_t blocks = (count + block - 1) / block;
    if (partial.size() < blocks) partial.resize(blocks);
    parallel_for(executor, count, block,
                 [&](std::size_t begin, std::size_t end) { partial[begin / block] = block_result(begin, end); });
    T result = identity;
    for (std::size_t b = 0; b < blocks; ++b) result = combine(result, partial[b]);
    return result;
}

}  // namespace skerry
