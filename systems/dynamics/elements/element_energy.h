// Energies and stress of the present state, for reports and output.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Elastic energy of the elements of a range of blocks [J]. Sequential, in element order.
Real elastic_energy(const ElementInputs& elements, Range blocks, std::span<const Vec3> position);

/// Power that the elastic forces of a range of blocks take from nodes with the given velocities: the rate of their
/// elastic energy [W]. Sequential, in element order.
Real elastic_power(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Vec3> velocity);

/// Cauchy stress of each element of a range of blocks: stress[8 (block - blocks.begin) + lane] [Pa]. It does not
/// include the part of the stress that relaxes.
void cauchy_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<Mat3> stress);

/// Cauchy stress of the elements of the blocks `asked`, ascending and counted from the first of the range:
/// stress[8 place in asked + lane] [Pa]. The values are bitwise those of cauchy_stress for the whole range.
void cauchy_stress_of_blocks(const ElementInputs& elements, Range blocks, std::span<const Index> asked,
                             std::span<const Vec3> position, std::span<Mat3> stress);

/// Green's strain (F^T F - I) / 2 of each element, in the order of cauchy_stress. Lanes without volume have zero.
void element_strains(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<Mat3> strain);

/// Von Mises stress of a Cauchy stress [Pa].
Real von_mises(const Mat3& cauchy);

}  // namespace skerry
