// How far tetrahedra and elements are pressed together, for reports.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Volume over that at rest: the smallest, who has it (lane of a block), how many are below near_inversion, and how
/// many below 0: inverted. A value that is not a number counts as the smallest.
struct VolumeRatios {
    Real smallest;
    Index item;
    Index near_inversion = 0, inverted = 0;
};
inline constexpr Real near_inversion = 0.1;

/// Of the tetrahedra of a range of blocks.
VolumeRatios tetrahedron_volume_ratios(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                                       Range blocks, std::span<const Vec3> position);

/// det F of the elements of a range of blocks; `near`: what counts as near inversion.
VolumeRatios element_volume_ratios(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                   Real near = near_inversion);

}  // namespace skerry
