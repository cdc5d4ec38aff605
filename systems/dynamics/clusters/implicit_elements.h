// What is asked of the elements that are left to clusters (docs/methods/clusters.md 2, 3).
#pragma once

#include <span>

#include "components/ragged.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

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

/// The least moment of inertia, of the integral of x x^T over the mass, x from its centre.
Real least_moment_of(const Mat3& spread);

/// What masses at the nodes, a quarter of each tetrahedron at each of its corners, add to the least moment of inertia
/// of a body of one density, over that moment. 0 of a body without volume.
Real moment_of_lumping(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                       std::span<const Vec3> position);

/// kg m^2/s^2 per Pa m^3: beta of A = M + beta sum K, for steps up to `step`.
constexpr Real inertia_of_stiffness(Real step) {
    constexpr Real safety = 1.8;  // step_times_frequency, in place of 2
    return step * step / (safety * safety);
}

}  // namespace skerry
