// Error of the stress of a body that is due to its mesh (docs/methods/error_estimates.md 1).
#pragma once

#include <vector>

#include "skerry/world.h"
#include "systems/dynamics/recovery/recover_nodes.h"

namespace skerry {

/// Comparison of the stress of a deformable body with the stress that is recovered at its nodes. All energies are
/// integrals of stress : strain, twice the elastic energy, with the strain that Hooke's law gives for the stress.
struct MeshError {
    std::vector<Real> volume;  // volumes of the tetrahedra at rest [m^3]
    // For each tetrahedron: energy of its stress, and of the difference between this and the recovered stress [J].
    std::vector<Real> energy, error;
    Real stored = 0;  // energy of the elements [J]
    // Additional energy that the body would store under the same loads, if its mesh were infinitely fine [J].
    Real missing = 0;
    // Root mean square of the error of linear interpolation of the displacements along the edges [m].
    Real interpolation = 0;
    // Largest von Mises stress at the nodes [Pa], and its relative error.
    Real largest_stress = 0, stress = 0;
    NodeFields nodes;            // recovered fields, in world axes
    std::vector<Real> of_nodes;  // by node: mean of relative_errors() over the tetrahedra around it

    /// Relative error of the stress of the tetrahedra, in the energy norm.
    Real mesh() const;
    /// Relative error of a displacement under given loads, positive if the mesh is too stiff.
    Real deflection() const;
    /// Results of mesh_error(): sqrt(e / E) for each tetrahedron. e: energy of the stress error of the tetrahedron, per
    /// volume. E: sum of the energies of the stress and of the stress error of the whole body, per volume.
    std::vector<Real> relative_errors() const;
};

/// Compares the stress of a body with the recovered stress. All errors are zero if the body is rigid or not deformed.
MeshError measure_mesh_error(const World& world, BodyHandle body);

}  // namespace skerry
