#include "systems/dynamics/elements/find_unstrained.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "components/range.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"

namespace skerry {

namespace {

constexpr std::size_t bodies_per_job = 16;
bool have_equal_velocity(std::span<const Vec3> velocity) {
    const Vec3& first = velocity.front();
    // The last node is compared first: it is far from the first node, so that rotation and vibration show at once.
    if (velocity.back() != first) return false;
    // number of velocities compared between two branches, so that the loop is vectorised
    constexpr std::size_t at_once = 64;
    const Real x = first[0], y = first[1], z = first[2];
    for (std::size_t begin = 0; begin < velocity.size(); begin += at_once) {
        const Real* const v = velocity[begin].data();
        const std::size_t count = std::min(at_once, velocity.size() - begin);
        unsigned other = 0;
#pragma omp simd reduction(| : other)
        for (std::size_t n = 0; n < count; ++n)
            other |= static_cast<unsigned>(v[3 * n] != x) | static_cast<unsigned>(v[3 * n + 1] != y) |
                     static_cast<unsigned>(v[3 * n + 2] != z);
        if (other != 0) return false;
    }
    return true;
}

bool is_zero(const SpringStrain& strain) {
    return std::ranges::all_of(strain, [](const auto& entry) {
        return std::ranges::all_of(entry.lane, [](float value) { return value == 0; });
    });
}

/// True if no element of a block is strained or rotated. Lanes without volume do not count. NaN counts as strained.
bool is_unstrained(const LaneMat3<Real8>& F, const ElementLane& volume) {
    const Real8 strain[9] = {F.c0.x - 1.0, F.c0.y, F.c0.z, F.c1.x, F.c1.y - 1.0, F.c1.z, F.c2.x, F.c2.y, F.c2.z - 1.0};
    for (std::size_t l = 0; l < element_lanes; ++l)
        if (volume.lane[l] > 0 &&
            !std::ranges::all_of(strain, [&](const Real8& entry) { return std::abs(entry[l]) <= unstrained_within; }))
            return false;
    return true;
}

bool is_unstrained(const UnstrainedInputs& inputs, Range blocks) {
    const ElementInputs& elements = inputs.elements;
    for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
        if (!elements.spring_strain.empty() && !is_zero(elements.spring_strain[b])) return false;
        if (!is_unstrained(deformation_gradient(elements.nodes_of(b), inputs.position), elements.volume[b]))
            return false;
    }
    return true;
}

std::uint16_t steps_unstrained(const UnstrainedInputs& inputs, std::size_t body, std::uint16_t before) {
    const Range nodes = inputs.body_nodes[body], blocks = inputs.body_blocks[body];
    if ((!inputs.body_idle.empty() && inputs.body_idle[body]) || blocks.size() == 0 ||
        !have_equal_velocity(rows_of(inputs.velocity, nodes)))
        return 0;
    if (before > 1) return static_cast<std::uint16_t>(before - 1);
    return is_unstrained(inputs, blocks) ? unstrained_steps : std::uint16_t{0};
}

}  // namespace

Index find_unstrained(Executor& executor, const UnstrainedInputs& inputs, const UnstrainedOutputs& out) {
    parallel_for(executor, out.unstrained.size(), bodies_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t body = begin; body < end; ++body) {
            const std::uint16_t before = out.unstrained[body];
            out.unstrained[body] = steps_unstrained(inputs, body, before);
            if (before > 0 || out.unstrained[body] == 0) continue;
            const Range blocks = inputs.body_blocks[body];
            std::ranges::copy(rows_of(inputs.rotation, blocks), rows_of(out.rotation_next, blocks).begin());
            if (!out.spring_strain_next.empty())
                std::ranges::fill(rows_of(out.spring_strain_next, blocks), SpringStrain{});
        }
    });
    return static_cast<Index>(std::ranges::count_if(out.unstrained, [](std::uint16_t steps) { return steps > 0; }));
}

}  // namespace skerry
