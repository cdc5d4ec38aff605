#include "systems/dynamics/measure_drift.h"

#include <algorithm>
#include <cmath>

#include "jobs/parallel_for.h"
#include "systems/dynamics/largest_length.h"

namespace skerry {

namespace {

constexpr std::size_t bodies_per_job = 64;

// Fraction of the mean edge. A pair loses up to four times this of its skin (a quarter of the edge) when it is searched, and what trembles by
// less loses nothing afterwards.
constexpr Real longest_drift = 0.0375;

}  // namespace

Real block_drift_squared(std::span<const Vec3> position, std::span<const Vec3> origin) {
    if (position.empty()) return 0;
    const Real *x = position.data()->data(), *o = origin.data()->data();
    return largest_squared_length(position.size(), [&](std::size_t i) { return x[i] - o[i]; });
}

void measure_drift(Executor& executor, const DriftInputs& bodies, const DriftOutputs& out) {
    parallel_for(executor, out.drift.size(), bodies_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            Real squared = 0;
            for (Index k = bodies.body_node_blocks[b].begin; k < bodies.body_node_blocks[b].end; ++k)
                squared = std::max(squared, bodies.block_drift_squared[k]);
            const Real drift = std::sqrt(squared);
            out.travel[b] += drift - out.drift[b];
            out.drift[b] = drift;
            const bool asked = b < out.rebase.size() && out.rebase[b] != 0;
            if (asked) out.rebase[b] = 0;
            if (!asked && drift <= longest_drift * bodies.body_mean_edge[b]) continue;
            out.drift[b] = 0;
            const auto first = static_cast<std::ptrdiff_t>(bodies.body_nodes[b].begin),
                       last = static_cast<std::ptrdiff_t>(bodies.body_nodes[b].end);
            std::copy(bodies.position.begin() + first, bodies.position.begin() + last, out.origin.begin() + first);
        }
    });
}

}  // namespace skerry
