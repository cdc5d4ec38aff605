// Which elements of a body stand impulses that come less often (docs/methods/stable_step.md 7.2).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

/// Coarser levels use this fraction of the step that level 0 would: 1.8 * 0.75 = 1.35 is below pi / 2, so that the
/// impulses of one level never come in time with the modes of the next finer one, whose steps are half as long
/// (resonance of impulse methods: Leimkuhler and Reich, Simulating Hamiltonian Dynamics, chapter 10). With 1 the energy
/// of a mesh with slivers grew by 1 % in 10^4 steps and ran away in 10^5.
inline constexpr Real coarse_safety = 0.75;

/// The step of level 0 that goes with a step of elements of some level.
constexpr Real step_of_level(Real step, int level) {
    return level == 0 ? step : coarse_safety * step / static_cast<Real>(1 << level);
}

/// level[8 (b - blocks.begin) + lane] of the elements of one body in the shape that it has: the highest for which
/// 2^level steps are stable by the bound of stiffness_share.h, with masses shared among elements of this level and of
/// higher ones only. So a node may belong to one sliver and many good elements, and only the sliver is fine: the others
/// would each get next to nothing of a mass shared among all. `step` is the stable step of the body, s; `stiffness_sum`
/// is scratch, one entry a node. Sequential, for new bodies.
void find_element_levels(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                         std::span<const Real> mass, Real step, std::span<Real> stiffness_sum,
                         std::span<std::uint8_t> level);

/// Viscous times (s) of the blocks of a body whose level 0 has the stable step `step`, sorted by level: fine blocks
/// beside coarse ones get some viscosity, 2 % of critical damping at their own highest frequency and less in proportion
/// below it. Impulses that come every 2^l steps are in time with some of the modes that take fewer than 2^(l + 1)
/// steps, and would pump them up by some per cent each time (docs/methods/stable_step.md 7.3); modes of neighbouring
/// levels are kept out of reach by coarse_safety. The stable step still holds: it needs omega h <= 2 (sqrt(1 +
/// zeta^2) - zeta) = 1.96 (docs/methods/time_stepping.md 3.2) and keeps 1.8.
void find_viscous_times(std::span<const std::uint8_t> block_level, Real step, std::span<Real> viscous_time);

}  // namespace skerry
