#include "systems/dynamics/checks/measure_work.h"

#include "jobs/reduce.h"

namespace skerry {

ExternalWork measure_work(Executor& executor, const WorkInputs& nodes, Real h, Real kick, Real lag,
                          Column<ExternalWork>& partial) {
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
                part.impulse += kick * nodes.load[n];
                part.work += h * nodes.load[n].dot(nodes.velocity_next[n]);
                if (lag == 0 && nodes.free.contain(n))
                    part.work += h / 2 * nodes.load[n].dot(nodes.velocity[n] - nodes.velocity_next[n]);
                if (lag != 0 && nodes.load[n] != nodes.load_before[n] && nodes.free.contain(n))
                    part.work += lag * (nodes.load[n] - nodes.load_before[n]).dot(nodes.velocity[n]);
            }
            return part;
        },
        join);
    for (const Index n : nodes.held) {
        // nodes with a mass are held along single directions only, see hold_axes
        if (nodes.free.inverse_mass[n] > 0 || nodes.resting.contain(static_cast<std::size_t>(n))) continue;
        const Vec3 &force = nodes.force[n], &velocity = nodes.velocity_next[n];
        ExternalWork hold{-kick * force, -kick * force.dot(velocity)};
        if (nodes.body_implicit[static_cast<std::size_t>(nodes.node_body[n])].size() == 0) {
            hold.work -= (h - kick) * nodes.mass[n] * nodes.gravity.dot(velocity);
            if (!nodes.load.empty()) hold.work -= (h - kick) * nodes.load[n].dot(velocity);
        }
        sum = join(sum, hold);
    }
    return sum;
}

}  // namespace skerry
