#include "systems/dynamics/checks/measure_work.h"

#include "jobs/reduce.h"

namespace skerry {

ExternalWork measure_work(Executor& executor, const WorkInputs& nodes, Real h, Column<ExternalWork>& partial) {
    constexpr std::size_t nodes_per_part = 4096;
    const auto join = [](const ExternalWork& a, const ExternalWork& b) {
        return ExternalWork{a.impulse + b.impulse, a.work + b.work};
    };
    ExternalWork sum = reduce(
        executor, nodes.load.size(), nodes_per_part, partial, ExternalWork{},
        [&](std::size_t begin, std::size_t end) {
            ExternalWork part;
            for (std::size_t n = begin; n < end; ++n) {
                if (nodes.resting.contain(n)) continue;
                part.impulse += h * nodes.load[n];
                part.work += h * nodes.load[n].dot(nodes.velocity_next[n]);
            }
            return part;
        },
        join);
    for (const Index n : nodes.held)
        if (!nodes.resting.contain(static_cast<std::size_t>(n)))
            sum = join(sum, {-h * nodes.force[n], -h * nodes.force[n].dot(nodes.velocity_next[n])});
    return sum;
}

}  // namespace skerry
