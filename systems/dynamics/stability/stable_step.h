// Bounds the longest stable step of symplectic Euler from below. The bound stays sharp in meshes with slivers, which
// are very flat tetrahedra (docs/methods/stable_step.md 1, 2).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/step_watch.h"
#include "jobs/executor.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Stable step of a body, from a bound on its highest circular frequency omega_max, and the element that limits it.
struct StableStep {
    Real step = 0;             // 0.9 * 2 / omega_max; infinite without elements; 0 if the shape is not finite [s]
    Index element = no_index;  // element that limits the step: lane e % 8 of block e / 8 of ElementBlockTable
};

/// Stable step of one body in its present shape. The step is rigorous: it is never longer than the exact limit.
/// Sequential, deterministic. `stiffness_sum`: work memory, one entry per node.
///
/// The bound follows from the highest frequencies of single elements, which share the mass of each node
/// (docs/methods/stable_step.md 1 to 4). The shares are those of frame_masses.h or mass_forms.h if the body has such
/// masses. Else they are in proportion to the stiffness of the elements and their mass_share.
StableStep stable_step(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, std::span<Real> stiffness_sum);

/// Number of pieces of a stable-step check. A check computes stable_step() in pieces that all take about the same time.
std::uint64_t pieces_of_check(const ElementInputs& elements, Range blocks);
/// Continues a stable-step check until `until` of its pieces are done. The result does not depend on where the check is
/// interrupted. `stiffness_sum` must be zero at the nodes of the body before the first piece. All inputs must stay the
/// same until the last piece.
void continue_check(Executor& executor, const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                    std::span<const Real> mass, std::span<Real> stiffness_sum, std::uint64_t until,
                    StepEvaluation& check);
/// Result of a stable-step check, available when all of its pieces are done.
StableStep result_of(const StepEvaluation& check);

/// Step that each element of these blocks would allow alone, with its mass shares [s]; infinite for inversion barriers
/// (guards), elements without stiffness and unused lanes. If the body has neither mass forms nor frame masses, the
/// shortest of these steps is the result of stable_step().
void element_steps(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> step);

/// Upper bound on the squared frequency of each element of these blocks, as if the element had all mass of its nodes
/// (frequency_squared_of()) [1/s^2].
void lone_frequencies(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const Real> mass, std::span<ElementLane> frequency_squared);

/// Upper bound on the Hessian dP/dF of each element of these blocks (stiffness_of()) [Pa].
void element_stiffnesses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                         std::span<ElementLane> stiffness);

/// Functions that compute bounds for every element of a range of blocks. The engine passes the versions for the
/// instruction set in use to systems that are not kernels.
struct ElementBounds {
    decltype(&skerry::element_steps) steps = &skerry::element_steps;
    decltype(&skerry::lone_frequencies) lone_frequencies = &skerry::lone_frequencies;
    decltype(&skerry::element_stiffnesses) stiffnesses = &skerry::element_stiffnesses;
};

/// Sharpens the bound of stable_step() by shifting mass from elements of low frequency to elements of high frequency,
/// in four rounds (docs/methods/stable_step.md 2.1). The bound is rigorous with any positive shares, so the shares
/// found for the rest shape serve for every shape. `mass_share`: shares of the blocks, to which start_mass_shares()
/// must have given their first values. Sequential, for new bodies.
void find_mass_shares(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const Real> mass, std::span<Real> stiffness_sum, std::span<ElementLane> mass_share);

}  // namespace skerry
