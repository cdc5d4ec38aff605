#include "systems/dynamics/measure_work.h"

#include "jobs/reduce.h"

namespace skerry {

ExternalWork measure_work(Executor& executor, std::span<const Vec3> load, std::span<const Vec3> force, std::span<const Index> held,
                          std::span<const Vec3> velocity_next, Real h, const RestingNodes& resting, Column<ExternalWork>& partial) {
    constexpr std::size_t nodes_per_block = 4096;
    const auto join = [](const ExternalWork& a, const ExternalWork& b) { return ExternalWork{a.impulse + b.impulse, a.work + b.work}; };
    ExternalWork sum = reduce(
        executor, load.size(), nodes_per_block, partial, ExternalWork{},
        [&](std::size_t begin, std::size_t end) {
            ExternalWork part;
            for (std::size_t n = begin; n < end; ++n) {
                if (resting.contain(n)) continue;
                part.impulse += h * load[n];
                part.work += h * load[n].dot(velocity_next[n]);
            }
            return part;
        },
        join);
    for (const Index n : held)
        if (!resting.contain(static_cast<std::size_t>(n))) sum = join(sum, {-h * force[n], -h * force[n].dot(velocity_next[n])});
    return sum;
}

}  // namespace skerry
