// Energies and stress of the present state, for reports and output.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Elastic energy of the elements of a range of blocks, J. Sequential, in element order.
Real elastic_energy(const ElementInputs& elements, Range blocks, std::span<const Vec3> position);

/// What the elastic forces of a range of blocks take from nodes that move with these velocities, W: the rate of their
/// elastic energy. Sequential, in element order.
Real elastic_power(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Vec3> velocity);

/// Cauchy stress (Pa) of each element of a range of blocks: stress[8 (block - blocks.begin) + lane]. What relaxes has
/// no part in it.
void cauchy_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<Mat3> stress);

/// The same of the blocks asked for, ascending and from 0 at the first of the range: stress[8 place in asked + lane].
/// To the bit what the whole range gives.
void cauchy_stress_of_blocks(const ElementInputs& elements, Range blocks, std::span<const Index> asked,
                             std::span<const Vec3> position, std::span<Mat3> stress);

/// Green's strain (F^T F - I) / 2 of each element, in the same order. What is left over has none.
void element_strains(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<Mat3> strain);

/// Pa, of a Cauchy stress.
Real von_mises(const Mat3& cauchy);

}  // namespace skerry
