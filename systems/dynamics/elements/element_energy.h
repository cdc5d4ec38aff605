// Computes energies and stresses of the present state, for reports and output.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Elastic energy of the elements in a range of blocks [J]. Sequential, in element order.
Real elastic_energy(const ElementInputs& elements, Range blocks, std::span<const Vec3> position);

/// Rate of change of the elastic energy of the elements in a range of blocks, at given node velocities [W]. Sequential,
/// in element order.
Real elastic_power(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Vec3> velocity);

/// Writes the Cauchy stress of each element in a range of blocks to stress[8 (block - blocks.begin) + lane] [Pa]. The
/// relaxing part of the stress is not included.
void cauchy_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<Mat3> stress);

/// Writes the Cauchy stress of the elements in some blocks of a range [Pa]. `asked`: these blocks, ascending and
/// counted from blocks.begin. Block asked[i] is written to stress[8 i + lane]. The values are bitwise those of
/// cauchy_stress for the whole range.
void cauchy_stress_of_blocks(const ElementInputs& elements, Range blocks, std::span<const Index> asked,
                             std::span<const Vec3> position, std::span<Mat3> stress);

/// Writes Green's strain (F^T F - I) / 2 of each element, in the order of cauchy_stress; zero in lanes without volume.
void element_strains(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<Mat3> strain);

/// Von Mises stress of a Cauchy stress tensor [Pa].
Real von_mises(const Mat3& cauchy);

}  // namespace skerry
