// Which elements of a body do not stand a step and are left to clusters (docs/methods/clusters.md 3).
#pragma once

#include <span>

#include "components/ragged.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// What is written of each block of the body.
struct ImplicitOutputs {
    std::span<ElementLane> mass_share;  // of implicit elements 0: they take no mass from their nodes
    std::span<ElementLane> modulus;     // Pa, stiffness that an implicit element is taken to have; 0: explicit
};

struct ImplicitShare {
    Real moment = 0;        // what the clusters add to the least moment of inertia of the body, over that moment
    bool too_many = false;  // three quarters of the volume do not stand the step: nothing is found
};

/// anew: all elements start explicit, and share their masses. more: those that are implicit stay so, shares stay, and
/// every other that does not stand the step becomes implicit: quick, but some would do with another share.
enum class ImplicitSearch { anew, more };

/// Shares the masses of a body anew, so that every explicit element stands `step` (s) in the shape that it has, and
/// makes implicit as few as it takes: those that need most of the masses of their nodes go first. Implicit elements
/// have `headroom` times the stiffness that they have now. `mass_share` and `modulus` are those of the inputs.
/// Sequential.
ImplicitShare find_implicit_elements(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                     std::span<const Real> mass, Real step, Real headroom, ImplicitSearch search,
                                     std::span<Real> stiffness_sum, const ImplicitOutputs& out);

/// How many times faster than others tetrahedra may deform: `of_implicit` times those that implicit elements cover,
/// which may turn over, too. `tetrahedra`: of each element, those that it covers.
void find_leeway(const Ragged<Index>& tetrahedra, std::span<const ElementLane> modulus, Real of_implicit,
                 std::span<ElementLane> leeway);

/// s, by block: for those with implicit elements the time that, times the modulus that these are taken to have, is
/// their viscosity; 0 for others. `step`: that of the body's clusters, s.
void find_viscous_times(std::span<const ElementLane> modulus, Real step, std::span<Real> viscous_time);

/// The largest factor by which an implicit element of the body is stiffer now than it is taken to be; 0 without any.
Real worst_stiffening(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const ElementLane> modulus);

/// J, what the inertia of implicit elements adds to the kinetic energy: v.(A - M) v / 2. `step`: that of the body's
/// clusters, s.
Real added_energy(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus, Real step,
                  std::span<const Vec3> velocity);

/// kg m^2/s^2 per Pa m^3: beta of A = M + beta sum K, for steps up to `step`.
constexpr Real inertia_of_stiffness(Real step) {
    constexpr Real safety = 1.8;  // step_times_frequency, in place of 2
    return step * step / (safety * safety);
}

}  // namespace skerry
