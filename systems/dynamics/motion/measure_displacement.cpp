#include "systems/dynamics/motion/measure_displacement.h"

#include <algorithm>
#include <cmath>

#include "jobs/parallel_for.h"
#include "systems/dynamics/stability/largest_length.h"

namespace skerry {

namespace {

// Number of bodies per job. A body whose displacement origins move takes a few microseconds.
constexpr std::size_t displaced_bodies_per_job = 16;

// Greatest allowed displacement (distance of a node from its displacement origin), as a fraction of the mean edge.
// Beyond it, measure_displacement() moves the origins to the nodes, which resets the displacement to zero.
// - With a greater limit lists of pairs expire sooner. A list with the margin `skin` is valid until the travels
//   (docs/methods/collision.md 2.1) of its two bodies have grown by skin - 2 (a + b), where a and b are their
//   displacements when it was made. With this limit they take at most 4 x 0.01 of the 0.3125 mean edges of the skin.
// - With a smaller limit more vibrating bodies exceed it, and each reset leaves the displacement in their travel.
constexpr Real longest_displacement = 0.01;

void advance_frame(MovingFrame& frame, Real seconds) {
    const Vec3 shift = seconds * frame.velocity;
    frame.offset += shift;
    frame.position += shift;
    frame.path += shift.norm();
}

/// Mean velocity of the nodes, or zero if the mean is not finite. A frame could have any velocity; with the mean
/// velocity the nodes move little relative to the frame.
Vec3 mean_velocity(std::span<const Vec3> velocity, Range nodes) {
    Vec3 sum = Vec3::Zero();
    for (Index n = nodes.begin; n < nodes.end; ++n) sum += velocity[static_cast<std::size_t>(n)];
    const Vec3 mean = sum / std::max(nodes.size(), Index{1});
    return mean.allFinite() ? mean : Vec3(Vec3::Zero());
}

/// Greatest speed of the nodes relative to a frame that moves with the velocity `frame` [m/s].
Real greatest_speed(std::span<const Vec3> velocity, Range nodes, const Vec3& frame) {
    Real squared = 0;
    for (Index n = nodes.begin; n < nodes.end; ++n)
        squared = std::max(squared, (velocity[static_cast<std::size_t>(n)] - frame).squaredNorm());
    return std::sqrt(squared);
}

}  // namespace

Real block_displacement_squared(std::span<const Vec3> position, std::span<const Vec3> origin, const Vec3& offset) {
    if (position.empty()) return 0;
    const Real *x = position.data()->data(), *o = origin.data()->data();
    return largest_squared_length(
        position.size(), [&](std::size_t i) { return x[i] - o[i]; }, offset);
}

void measure_displacement(Executor& executor, const DisplacementInputs& bodies, Real seconds,
                          const DisplacementOutputs& out) {
    parallel_for(executor, out.displacement.size(), displaced_bodies_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            Real squared = 0;
            for (Index k = bodies.body_node_blocks[b].begin; k < bodies.body_node_blocks[b].end; ++k)
                squared = std::max(squared, bodies.block_displacement_squared[k]);
            const Real displacement = std::sqrt(squared);
            advance_frame(out.frame[b], seconds);
            out.travel[b] += displacement - out.displacement[b];
            out.displacement[b] = displacement;
            const bool asked = b < out.rebase.size() && out.rebase[b] != 0;
            if (asked) out.rebase[b] = 0;
            if (!asked && displacement <= longest_displacement * bodies.body_mean_edge[b]) continue;
            out.displacement[b] = 0;
            out.frame[b].offset = Vec3::Zero();
            const Range nodes = bodies.nodes(b);
            out.frame[b].velocity = mean_velocity(bodies.velocity, nodes);
            // This speed must be relative to the new frame: the contact search of the next step uses it together with
            // this frame (step_reach.cpp).
            out.frame_speed[b] = greatest_speed(bodies.velocity, nodes, out.frame[b].velocity);
            const auto first = static_cast<std::ptrdiff_t>(nodes.begin), last = static_cast<std::ptrdiff_t>(nodes.end);
            std::copy(bodies.position.begin() + first, bodies.position.begin() + last, out.origin.begin() + first);
        }
    });
}

}  // namespace skerry
