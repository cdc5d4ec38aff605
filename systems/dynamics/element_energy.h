// Energies and stress of the present state, for reports and output.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/compute_element_forces.h"

namespace skerry {

/// Elastic energy of the elements of a range of blocks, J. Sequential, in element order.
Real elastic_energy(const ElementInputs& elements, Range blocks, std::span<const Vec3> position);

/// Von Mises stress (Pa, of the Cauchy stress) of each element of a range of blocks: von_mises[8 (block - blocks.begin) + lane].
void von_mises_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<Real> von_mises);

/// Smallest det F over the elements of a range of blocks, and which element: < 0 is inverted.
struct WorstElement {
    Real volume_ratio;
    Index element;
};
WorstElement worst_volume_ratio(const ElementInputs& elements, Range blocks, std::span<const Vec3> position);

}  // namespace skerry
