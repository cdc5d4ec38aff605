// Ratios of present volume to rest volume for tetrahedra and for elements. The ratios are used in reports.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Statistics of the ratio of present volume to rest volume, over some tetrahedra or elements. `smallest`: the smallest
/// ratio; NaN counts as the smallest. `item`: index i of the tetrahedron or element with the smallest ratio, which is
/// in lane i % 8 of block i / 8. `near_inversion`: number of ratios below a limit (0.1 unless another one is given).
/// `inverted`: number of ratios below 0.
struct VolumeRatios {
    Real smallest;
    Index item;
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
