// Properties of implicit elements: allowed change of the deformation gradient, viscosity, stiffening, and added inertia
// (docs/methods/clusters.md 2, 3).
#pragma once

#include <span>

#include "components/ragged.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Writes the leeway of each tetrahedron: a factor on the allowed change of the deformation gradient in a step. The
/// factor is `leeway_of_implicit` for a tetrahedron over which an implicit element averages its deformation gradient,
/// else 1.
/// - `tetrahedra`: for each element, lane by lane, the tetrahedra over which it averages.
/// - `modulus`: assumed modulus of an implicit element; 0 for an explicit element [Pa].
void find_leeway(const Ragged<Index>& tetrahedra, std::span<const ElementLane> modulus, Real leeway_of_implicit,
                 std::span<ElementLane> leeway);

/// Writes the viscous time of each block with implicit elements: viscosity over assumed modulus [s]. Other blocks get
/// 0. `step`: longest step at which the implicit elements are stable (BodyTable::cluster_step) [s].
void find_viscous_times(std::span<const ElementLane> modulus, Real step, std::span<Real> viscous_time);

/// Largest ratio of the present stiffness to the assumed stiffness (`modulus`) of the implicit elements of a body; 0
/// without implicit elements.
Real worst_stiffening(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<const ElementLane> modulus);

/// Kinetic energy that the inertia of implicit elements adds: v.(A - M) v / 2, with the node velocities v, the inertia
/// matrix A of the clusters, and the matrix M of lumped masses [J]. `step`: BodyTable::cluster_step [s].
Real added_energy(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus, Real step,
                  std::span<const Vec3> velocity);

/// Least principal moment of inertia of a body. `spread`: integral of x x^T over the mass, with x measured from the
/// centre of mass.
Real least_moment_of(const Mat3& spread);

/// Relative error of the least principal moment of inertia that lumped masses cause. Lumping moves a quarter of the
/// mass of each tetrahedron, which has uniform density, to each corner. Returns 0 for a body without volume.
Real moment_of_lumping(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                       std::span<const Vec3> position);

/// Factor beta in the inertia matrix of clusters [s^2]: A = M + beta (sum of assumed element stiffnesses), with the
/// matrix M of lumped masses. With this beta, steps up to `step` [s] are stable.
constexpr Real inertia_factor(Real step) {
    // upper bound on circular frequency times step (step_times_frequency); the stability limit is 2
    constexpr Real safety = 1.8;
    return step * step / (safety * safety);
}

}  // namespace skerry
