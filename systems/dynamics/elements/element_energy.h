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

/// Von Mises stress (Pa, of the Cauchy stress) of each element of a range of blocks: von_mises[8 (block - blocks.begin)
/// + lane].
void von_mises_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                      std::span<Real> von_mises);

/// det F over the elements of a range of blocks: the smallest, which element has it, how many are below near_inversion,
/// and how many below 0: inverted. A value that is not a number counts as the smallest.
struct VolumeRatios {
    Real smallest;
    Index element;
    Index near_inversion = 0, inverted = 0;
};
inline constexpr Real near_inversion = 0.1;
VolumeRatios measure_volume_ratios(const ElementInputs& elements, Range blocks, std::span<const Vec3> position);

}  // namespace skerry
