// Finds the parts of a mesh that are only a few cells thick, and estimates how much too stiff they are in bending.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "skerry/mesh.h"
#include "systems/dynamics/kinds/element_list.h"

namespace skerry::mesh {

/// Elastic constants of a material.
struct ElasticConstants {
    Real young_modulus;  // Young's modulus [Pa]
    Real poisson_ratio;  // Poisson's ratio
};

/// A part of a mesh that is a few cells thick and several times as long as it is thick. Parts with a very small
/// fraction of the volume of the mesh are not listed.
struct ThinPart {
    Vec3 place = Vec3::Zero();  // mean of the centroids of the boundary triangles of the part [m]
    Real thickness = 0;         // mean thickness [m]
    Real length = 0;            // longest extent [m]
    Real layers = 0;            // mean number of layers of cells through the thickness
    Real volume = 0;            // estimate of its volume [m^3]
    // Estimated bending stiffness of the elements, divided by the exact bending stiffness of a part of this material.
    Real stiffness = 1;
};

/// Returns the thin parts of a mesh. Each has an estimate of its stiffness in pure bending relative to the exact one,
/// from the elastic energies (docs/methods/elasticity.md 7.8). All tetrahedra must have positive volumes.
///
/// The mesh is thin at a boundary triangle if a ray along the inner normal leaves it within two mean edge lengths,
/// through a triangle nearly perpendicular to the ray. A part consists of neighbouring triangles of this kind.
///
/// - `boundary`: boundary triangles of the mesh.
/// - `zones`: elements of the body; MaterialZone::material is an index into `materials`.
std::vector<ThinPart> thin_parts(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary,
                                 std::span<const MaterialZone> zones, std::span<const ElasticConstants> materials);

}  // namespace skerry::mesh
