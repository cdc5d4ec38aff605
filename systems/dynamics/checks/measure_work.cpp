#include "systems/dynamics/checks/measure_work.h"

#include "jobs/reduce.h"

namespace skerry {

namespace {

void add_load(const WorkInputs& nodes, std::size_t n, Real h, Real kick, Real lag, ExternalWork& sum) {
    sum.impulse += kick * nodes.load[n];
    sum.flow += kick * nodes.load[n].norm();
    sum.work += h * nodes.load[n].dot(nodes.velocity_next[n]);
    if (!nodes.free.contain(n)) return;
    if (lag == 0) sum.work += h / 2 * nodes.load[n].dot(nodes.velocity[n] - nodes.velocity_next[n]);
    if (lag != 0 && nodes.load[n] != nodes.load_before[n])
        sum.work += lag * (nodes.load[n] - nodes.load_before[n]).dot(nodes.velocity[n]);
}

/// Adds impulse and work of the force that holds a node completely. For nodes held along single directions see
/// hold_axes.
void add_hold(const WorkInputs& nodes, std::size_t n, Real h, Real kick, ExternalWork& sum) {
    const Vec3 &force = nodes.force[n], &velocity = nodes.velocity_next[n];
    sum.impulse -= kick * force;
    sum.flow += kick * force.norm();
    sum.work -= kick * force.dot(velocity);
    if (nodes.body_implicit[static_cast<std::size_t>(nodes.node_body[n])].size() > 0) return;
    sum.work -= (h - kick) * nodes.mass[n] * nodes.gravity.dot(velocity);
    if (!nodes.load.empty()) sum.work -= (h - kick) * nodes.load[n].dot(velocity);
}

}  // namespace

ExternalWork measure_work(Executor& executor, const WorkInputs& nodes, Real h, Real kick, Real lag,
                          Column<ExternalWork>& partial) {
    constexpr std::size_t nodes_per_part = 4096;
    const bool is_loaded = !nodes.load.empty(), holds = !nodes.held.empty();
    return reduce(
        executor, is_loaded || holds ? nodes.free.inverse_mass.size() : 0, nodes_per_part, partial, ExternalWork{},
        [&](std::size_t begin, std::size_t end) {
            ExternalWork part;
            for (std::size_t n = begin; n < end; ++n) {
                if (nodes.resting.contain(n) || nodes.ghosts.contain(nodes.node_body[n])) continue;
                if (is_loaded) add_load(nodes, n, h, kick, lag, part);
                if (holds && !(nodes.free.inverse_mass[n] > 0)) add_hold(nodes, n, h, kick, part);
            }
            return part;
        },
        [](const ExternalWork& a, const ExternalWork& b) {
            return ExternalWork{a.impulse + b.impulse, a.work + b.work, a.flow + b.flow};
        });
}

}  // namespace skerry
