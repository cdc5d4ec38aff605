// Properties of implicit elements: leeway, viscosity, stiffening, added inertia (docs/methods/clusters.md 2, 3).
#pragma once

#include <span>

#include "components/ragged.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Writes the leeway of tetrahedra, the factor on the allowed change of F: `of_implicit` if an implicit element covers
/// the tetrahedron, which may then also invert, else 1. `tetrahedra`: those that each element covers.
void find_leeway(const Ragged<Index>& tetrahedra, std::span<const ElementLane> modulus, Real of_implicit,
                 std::span<ElementLane> leeway);

/// Writes the viscosity over the assumed modulus of the implicit elements, by block; 0 for blocks without implicit
/// elements [s]. `step`: step of the body's clusters [s].
void find_viscous_times(std::span<const ElementLane> modulus, Real step, std::span<Real> viscous_time);

/// The largest present stiffness over assumed stiffness of the implicit elements of the body; 0 without any.
Real worst_stiffening(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const ElementLane> modulus);

/// Kinetic energy that the inertia of implicit elements adds, v.(A - M) v / 2 [J]. `step`: step of the body's clusters
/// [s].
Real added_energy(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus, Real step,
                  std::span<const Vec3> velocity);

/// The least moment of inertia. `spread`: integral of x x^T over the mass, x relative to the centre of mass.
Real least_moment_of(const Mat3& spread);

/// Relative increase of the least moment of inertia of a body of uniform density if a quarter of the mass of each
/// tetrahedron is placed at each of its corners. 0 for a body without volume.
Real moment_of_lumping(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                       std::span<const Vec3> position);

/// beta of A = M + beta sum K, for steps up to `step` [s^2].
constexpr Real inertia_of_stiffness(Real step) {
    constexpr Real safety = 1.8;  // step_times_frequency; the limit is 2
    return step * step / (safety * safety);
}

}  // namespace skerry
