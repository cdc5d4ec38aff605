#include "systems/forces/add_nodal_loads.h"

#include <algorithm>

#include "jobs/parallel_for.h"

namespace skerry {

void add_nodal_loads(Executor& executor, std::span<const Vec3> load, std::span<Vec3> applied_force) {
    constexpr std::size_t nodes_per_block = 4096;
    parallel_for(executor, load.size(), nodes_per_block, [&](std::size_t begin, std::size_t end) {
        std::ranges::copy(load.subspan(begin, end - begin), applied_force.subspan(begin, end - begin).begin());
    });
}

}  // namespace skerry
