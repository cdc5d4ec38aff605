// Compression of tetrahedra and elements, for reports.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Statistics of present volume over rest volume: the smallest ratio, the item that has it (lane of a block), the
/// number below near_inversion (or another limit), and the number below 0 (inverted). NaN counts as the smallest.
struct VolumeRatios {
    Real smallest;
    Index item;
    Index near_inversion = 0, inverted = 0;
};
inline constexpr Real near_inversion = 0.1;

/// Volume ratios of the tetrahedra of a range of blocks.
VolumeRatios tetrahedron_volume_ratios(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                                       Range blocks, std::span<const Vec3> position);

/// Volume ratios det F of the elements of a range of blocks; below `near` they count as near inversion.
VolumeRatios element_volume_ratios(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                   Real near = near_inversion);

}  // namespace skerry
