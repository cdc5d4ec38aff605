#include "systems/forces/add_nodal_loads.h"

#include <algorithm>

#include "jobs/parallel_for.h"

namespace skerry {

namespace {

void copy(Executor& executor, std::span<const Vec3> from, std::span<Vec3> to) {
    constexpr std::size_t nodes_per_block = 4096;
    parallel_for(executor, from.size(), nodes_per_block, [&](std::size_t begin, std::size_t end) {
        std::ranges::copy(from.subspan(begin, end - begin), to.subspan(begin, end - begin).begin());
    });
}

}  // namespace

void add_nodal_loads(Executor& executor, std::span<const Vec3> load, std::span<Vec3> applied_force) {
    copy(executor, load, applied_force);
}

void keep_applied_forces(Executor& executor, std::span<const Vec3> applied_force, std::span<Vec3> applied_before) {
    copy(executor, applied_force, applied_before);
}

}  // namespace skerry
