// Parallel loops over rows. The rows are divided into fixed blocks.
#pragma once

#include <algorithm>

#include "jobs/executor.h"

namespace skerry {

/// Divides the rows 0 .. count - 1 into consecutive blocks of at most `block` rows and calls body(begin, end) for each
/// block. A single block runs on the calling thread. The division does not depend on the number of workers.
template <class Body>
void parallel_for(Executor& executor, std::size_t count, std::size_t block, Body&& body) {
    if (count == 0) return;
    if (count <= block) {
        body(std::size_t{0}, count);
        return;
    }
    const std::size_t blocks = (count + block - 1) / block;
    executor.run_blocks(static_cast<Index>(blocks), [&](Index b) {
        const std::size_t begin = static_cast<std::size_t>(b) * block;
        body(begin, std::min(begin + block, count));
    });
}

}  // namespace skerry
