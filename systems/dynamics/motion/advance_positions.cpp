#include "systems/dynamics/motion/advance_positions.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/motion/measure_displacement.h"

namespace skerry {

namespace {

constexpr std::size_t moved_blocks_per_job = 8;

/// Drift in a step without push-out: moves positions by the velocities. Treats node vectors as flat lists of numbers,
/// so that the compiler can vectorise the loop.
void drift(std::span<const Vec3> velocity, Real h, std::span<Vec3> position) {
    const Real* v = velocity.data()->data();
    Real* x = position.data()->data();
    const std::size_t count = 3 * position.size();
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) x[i] += h * v[i];
}

/// Drift in a step in which contacts push nodes out of an overlap: moves positions by the velocities and push
/// velocities. Then clears push_out in blocks with a pushed node. In all other blocks, which are the majority, push_out
/// is already zero.
void drift_pushed(std::span<const Vec3> velocity, Real h, std::span<Vec3> push_out, std::span<Vec3> position) {
    const Real *v = velocity.data()->data(), *p = push_out.data()->data();
    Real* x = position.data()->data();
    const std::size_t count = 3 * position.size();
    std::uint64_t pushed = 0;  // bitwise OR of all push velocities; the sign bits are ignored, since -0 pushes nothing
#pragma omp simd reduction(| : pushed)
    for (std::size_t i = 0; i < count; ++i) {
        x[i] += h * (v[i] + p[i]);
        pushed |= std::bit_cast<std::uint64_t>(p[i]);
    }
    if (pushed << 1 != 0) std::ranges::fill(push_out, Vec3::Zero());
}

}  // namespace

void advance_positions(Executor& executor, const AdvanceInputs& nodes, Real h, const AdvanceOutputs& out) {
    SKERRY_CHECK(nodes.velocity_next.size() == out.position.size() && out.velocity.size() == out.position.size());
    SKERRY_CHECK(out.push_out.empty() || out.push_out.size() == out.position.size());
    parallel_for(executor, nodes.block_begin.size(), moved_blocks_per_job, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b) {
            const auto begin = static_cast<std::size_t>(nodes.block_begin[b]);
            const std::size_t count = static_cast<std::size_t>(nodes.block_end[b]) - begin;
            const std::span<Vec3> position = out.position.subspan(begin, count),
                                  velocity = out.velocity.subspan(begin, count);
            const std::span<const Vec3> velocity_next = nodes.velocity_next.subspan(begin, count);
            if (nodes.body_asleep.empty() || !nodes.body_asleep[static_cast<std::size_t>(nodes.block_body[b])]) {
                if (out.push_out.empty())
                    drift(velocity_next, h, position);
                else
                    drift_pushed(velocity_next, h, out.push_out.subspan(begin, count), position);
                std::copy(velocity_next.begin(), velocity_next.end(), velocity.begin());
            }
            const MovingFrame frame = nodes.body_frame.empty()
                                          ? MovingFrame{}
                                          : nodes.body_frame[static_cast<std::size_t>(nodes.block_body[b])];
            out.block_displacement_squared[b] = block_displacement_squared(
                position, nodes.displacement_origin.subspan(begin, count), frame.offset + h * frame.velocity);
        }
    });
}

}  // namespace skerry
