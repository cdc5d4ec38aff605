// The largest step that symplectic Euler stands, from a bound that survives slivers (docs/methods/stable_step.md 1, 2).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/step_watch.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// What bounds a body's step and where.
struct StableStep {
    Real step = 0;             // s, 0.9 * 2 / omega_max; infinity for a body without elements
    Index element = no_index;  // of ElementBlockTable (lane e % 8 of block e / 8): the element that bounds it
};

/// Stable step of one body in its present shape: the mass of each node is shared among its elements by frame_masses.h
/// or mass_forms.h, where they have such, or in proportion to their stiffness and their mass_share, and omega_max^2 <=
/// max_e lambda_max(M_e^-1/2 K_e M_e^-1/2), with the material Hessian of the present deformation bounded as
/// docs/methods/stable_step.md 4 gives it. A rigorous bound (never above the exact limit), sequential, deterministic.
/// `stiffness_sum` is scratch, one entry a node.
StableStep stable_step(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, std::span<Real> stiffness_sum);

/// Number of pieces of the same computation done in parts, a look. All pieces take about as long as each other.
std::uint64_t pieces_of_look(const ElementInputs& elements, Range blocks);
/// Goes on with a look until `until` of its pieces are done. `stiffness_sum` is zero at the nodes of the body before
/// the first; all inputs stay the same until the last. Where a look is cut does not change what it finds.
void continue_look(Executor& executor, const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::uint64_t until, StepLook& look);
/// What a look has found when all of its pieces are done.
StableStep result_of(const StepLook& look);

/// The step that each element of these blocks allows by itself (s), with the shares of masses that it has: the shortest
/// is that of stable_step, or below it where the body goes by mass forms, by which all elements allow the same at rest.
/// Infinity where nothing bounds a step, and in lanes left over.
void element_steps(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> step);

/// Makes the bound of stable_step sharper: elements whose own bound is low give mass to those whose is high,
/// s <- s omega / omega_max, four times over (docs/methods/stable_step.md 2.1). The bound is rigorous with any positive
/// shares, so that shares of the rest shape serve for every other. `mass_share`: of the blocks, all 1 before.
/// Sequential, for new bodies.
void find_mass_shares(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> mass_share);

/// omega_max^2 of the rest stiffness by power iteration on the assembled linear operator (an estimate from below,
/// docs/methods/stable_step.md 5): for tests and reports.
Real estimate_max_frequency_squared(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> inverse_mass, int iterations);

}  // namespace skerry
