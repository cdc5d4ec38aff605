// Scenes of profile_stiff_peers. They are those of profile_stiff and profile_cantilever in a form for all engines.
#pragma once

#include <string_view>

#include "profiling/work_precision/scene.h"

namespace skerry::profiling {

inline constexpr Real incline_friction = 0.3;
inline constexpr Real incline_below = -0.5, incline_above = 2;  // offsets from the friction angle [degrees]

/// Makes a scene by name. "holds" and "slides" are a block on an incline below and above the friction angle.
/// "cantilever" is let go under gravity. "stack" has eight blocks, 1 cm apart. "ball on block" is a rigid sphere that
/// falls on a soft block. "pile" has 27 cubes in a box. Throws std::invalid_argument for other names. Edges are as long
/// as in profile_stiff divided by `finer`.
PrecisionScene make_stiff_scene(std::string_view name, Real young_modulus, int finer = 1);

/// Prepares a scene for Drake, which keeps no contact distance: a body that stood at that distance from a plane lies on
/// it. It starts as deep in the plane as Drake's contacts yield under the weight of a block. If it started at height
/// zero, the block of 1e6 Pa would hop and never slide.
PrecisionScene without_distance(PrecisionScene scene);

}  // namespace skerry::profiling
