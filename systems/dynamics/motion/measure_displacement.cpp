#include "systems/dynamics/motion/measure_displacement.h"

#include <algorithm>
#include <cmath>

#include "jobs/parallel_for.h"
#include "systems/dynamics/stability/largest_length.h"

namespace skerry {

namespace {

constexpr std::size_t bodies_per_job = 64;

// Fraction of the mean edge at which the origins move to the nodes. A list of a pair made at drifts a and b holds for
// skin - 2 (a + b) of travel (contact_reach.h): at most 4 x 0.0375 = 0.15 of the skin of 0.25 mean edges is lost. A
// body that trembles by less than this adds nothing to its travel in the long run.
constexpr Real longest_displacement = 0.0375;

}  // namespace

Real block_displacement_squared(std::span<const Vec3> position, std::span<const Vec3> origin) {
    if (position.empty()) return 0;
    const Real *x = position.data()->data(), *o = origin.data()->data();
    return largest_squared_length(position.size(), [&](std::size_t i) { return x[i] - o[i]; });
}

void measure_displacement(Executor& executor, const DisplacementInputs& bodies, const DisplacementOutputs& out) {
    parallel_for(executor, out.displacement.size(), bodies_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            Real squared = 0;
            for (Index k = bodies.body_node_blocks[b].begin; k < bodies.body_node_blocks[b].end; ++k)
                squared = std::max(squared, bodies.block_displacement_squared[k]);
            const Real displacement = std::sqrt(squared);
            out.travel[b] += displacement - out.displacement[b];
            out.displacement[b] = displacement;
            const bool asked = b < out.rebase.size() && out.rebase[b] != 0;
            if (asked) out.rebase[b] = 0;
            if (!asked && displacement <= longest_displacement * bodies.body_mean_edge[b]) continue;
            out.displacement[b] = 0;
            const auto first = static_cast<std::ptrdiff_t>(bodies.body_nodes[b].begin),
                       last = static_cast<std::ptrdiff_t>(bodies.body_nodes[b].end);
            std::copy(bodies.position.begin() + first, bodies.position.begin() + last, out.origin.begin() + first);
        }
    });
}

}  // namespace skerry
