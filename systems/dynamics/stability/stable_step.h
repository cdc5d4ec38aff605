// Largest stable step of symplectic Euler, from a bound that slivers do not spoil (docs/methods/stable_step.md 1, 2).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/step_watch.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Stable step of a body, and the element that bounds it.
struct StableStep {
    Real step = 0;             // 0.9 * 2 / omega_max; infinity for a body without elements [s]
    Index element = no_index;  // element that bounds it: lane e % 8 of block e / 8 of ElementBlockTable
};

/// Stable step of one body in its present shape. The mass of each node is shared among its elements by frame_masses.h
/// or mass_forms.h, where they have such masses, or in proportion to their stiffness and their mass_share. Then
/// omega_max^2 <= max_e lambda_max(M_e^-1/2 K_e M_e^-1/2), with the material Hessian of the present deformation bounded
/// as in docs/methods/stable_step.md 4. The step is rigorous (never above the exact limit). Sequential, deterministic.
/// `stiffness_sum` is work memory, one entry a node.
StableStep stable_step(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, std::span<Real> stiffness_sum);

/// Number of pieces of a look: the computation of stable_step(), done in parts that all take about as long as each
/// other.
std::uint64_t pieces_of_look(const ElementInputs& elements, Range blocks);
/// Continues a look until `until` of its pieces are done. `stiffness_sum` is zero at the nodes of the body before the
/// first piece; all inputs stay the same until the last. The result does not depend on where a look is cut.
void continue_look(Executor& executor, const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::uint64_t until, StepLook& look);
/// Result of a look when all of its pieces are done.
StableStep result_of(const StepLook& look);

/// Step that each element of these blocks allows by itself, with its shares of mass [s]. The shortest is that of
/// stable_step(), or below it if the body uses mass forms, by which all elements allow the same step at rest. Infinity
/// where nothing bounds a step, and in unused lanes.
void element_steps(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> step);

/// Makes the bound of stable_step() sharper: elements whose own frequency is low give mass to those whose frequency is
/// high, s <- s omega / omega_max, four times over (docs/methods/stable_step.md 2.1). The bound is rigorous with any
/// positive shares, so that shares of the rest shape serve for every other. `mass_share`: of the blocks, before as
/// start_mass_shares() sets them. Sequential, for new bodies.
void find_mass_shares(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> mass_share);

/// Estimate of omega_max^2 of the rest stiffness from below [1/s^2], by power iteration on the assembled linear
/// operator (docs/methods/stable_step.md 5). For tests and reports.
Real estimate_max_frequency_squared(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> inverse_mass, int iterations);

}  // namespace skerry
