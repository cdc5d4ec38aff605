#include "systems/dynamics/checks/limit_impulses.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "jobs/reduce.h"
#include "systems/dynamics/checks/check_state.h"
#include "systems/dynamics/elements/element_block.h"

namespace skerry {

namespace {

constexpr std::size_t limited_blocks_per_job = 256;
// not infinite: files hold finite numbers
constexpr Real no_limit = std::numeric_limits<Real>::max();

Real impulse_of_level(Real h, int level) {
    return std::ldexp(h, level);
}

/// Levels, within the body, of whose elements the greatest speed alone does not tell that they are slow enough. Those
/// of slivers often are among them, and few elements are of these.
unsigned levels_to_look_at(const ImpulseLimitInputs& inputs, std::size_t body, Real h, Real max_strain_step) {
    unsigned levels = 0;
    for (int k = 0; k < element_level_count; ++k) {
        const auto level = static_cast<std::size_t>(k);
        const int in_world = inputs.body_level[body] + k;
        if (in_world == 0 || inputs.body_level_count[body][level] == 0) continue;
        const Real rate = inputs.body_frame_speed[body] * inputs.body_steepness[body][level];
        if (!(rate * impulse_of_level(h, in_world) <= max_strain_step)) levels |= 1u << k;
    }
    return levels;
}

/// Of one block whose elements have this level in the world.
Real longest_of_block(const ImpulseLimitInputs& inputs, std::size_t block, Real h, int level, Real max_strain_step) {
    if (inputs.element_touched[block]) return no_limit;
    const auto first = static_cast<std::size_t>(inputs.element_first[block]);
    const BlockNodes nodes{&inputs.element_node[first], &inputs.element_gradient[first], inputs.element_count[block]};
    const LaneMat3<Real8> change = deformation_gradient(nodes, inputs.velocity_next);
    const Real8 one = Real8{} + 1.0, implicit = one / (implicit_leeway * implicit_leeway);
    const Real8 rate_squared =
        inner_product(change, change) * (load(inputs.element_implicit_modulus[block]) > 0.0 ? implicit : one);
    Real most = 0;
    for (std::size_t l = 0; l < element_lanes; ++l) most = std::max(most, rate_squared[l]);
    const Real rate = std::sqrt(most);
    return rate * impulse_of_level(h, level) > max_strain_step ? max_strain_step / rate : no_limit;
}

}  // namespace

void limit_impulses(Executor& executor, const ImpulseLimitInputs& inputs, Real h, Real max_strain_step, bool look,
                    Column<Real>& partial, std::span<Real> longest) {
    for (std::size_t body = 0; body < inputs.body_blocks.size(); ++body) {
        const Range blocks = inputs.body_blocks[body];
        if (blocks.size() == 0 || inputs.body_asleep[body]) continue;
        const unsigned levels = levels_to_look_at(inputs, body, h, max_strain_step);
        if (levels == 0) {
            longest[body] = no_limit;
            continue;
        }
        if (!look) continue;
        const auto first = static_cast<std::size_t>(blocks.begin);
        const int level = inputs.body_level[body];
        longest[body] = reduce(
            executor, static_cast<std::size_t>(blocks.size()), limited_blocks_per_job, partial, no_limit,
            [&](std::size_t begin, std::size_t end) {
                Real least = no_limit;
                for (std::size_t b = first + begin; b < first + end; ++b) {
                    if ((levels >> inputs.element_level[b] & 1u) == 0) continue;
                    least = std::min(least,
                                     longest_of_block(inputs, b, h, level + inputs.element_level[b], max_strain_step));
                }
                return least;
            },
            [](Real a, Real b) { return std::min(a, b); });
    }
}

}  // namespace skerry
