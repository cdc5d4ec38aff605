// Reductions (sums, minima, maxima) over rows. Their results are bitwise equal on any number of workers.
#pragma once

#include <type_traits>

#include "components/column.h"
#include "jobs/parallel_for.h"

namespace skerry {

/// Calls block_result(begin, end) for blocks of at most `block` rows, concurrently, and combines the results in block
/// order: combine(... combine(combine(identity, r_0), r_1) ...). The fixed order makes the rounding of floating-point
/// sums reproducible. `partial`: memory for the results r_0, r_1, ..., reused by later calls.
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
