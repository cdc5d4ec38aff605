// Ratios of present volume to rest volume for tetrahedra and for elements. The ratios are used in reports.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Statistics of the ratio of present volume to rest volume, over some tetrahedra or elements.
struct VolumeRatios {
    Real smallest;  // smallest ratio; NaN counts as the smallest
    Index item;     // tetrahedron or element with the smallest ratio: lane item % 8 of block item / 8
    // numbers of ratios below a limit (0.1 unless another one is given), and below 0
    Index near_inversion = 0, inverted = 0;
};
inline constexpr Real near_inversion = 0.1;

/// Statistics of the volume ratios of the tetrahedra in a range of blocks.
VolumeRatios tetrahedron_volume_ratios(std::span<const TetrahedronNodes> node, std::span<const ElementLane> volume,
                                       Range blocks, std::span<const Vec3> position);

/// Statistics of the volume ratios det F of the elements in a range of blocks. Ratios below `near` count as near
/// inversion. Inversion barriers (guards) get the ratio 1, so they never count as near inversion.
VolumeRatios element_volume_ratios(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                   Real near = near_inversion);

}  // namespace skerry
