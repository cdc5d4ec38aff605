// The scenes of profile_stiff_peers, which are those of profile_stiff and of profile_cantilever as all engines get
// them.
#pragma once

#include <string_view>

#include "profiling/work_precision/scene.h"

namespace skerry::profiling {

inline constexpr Real incline_friction = 0.3;
inline constexpr Real incline_below = -0.5, incline_above = 2;  // degrees from the angle at which the block slides

/// "holds" and "slides": a block on an incline below and above that angle; "cantilever", which is let go under gravity;
/// "stack" of eight blocks, 1 cm apart; "ball on block": a rigid sphere that falls on a soft block; "pile" of 27 cubes
/// in a box. Throws std::invalid_argument for other names. Edges are as long as in profile_stiff divided by `finer`.
PrecisionScene make_stiff_scene(std::string_view name, Real young_modulus, int finer = 1);

/// For Drake, which keeps no distance: what stood this far from a plane lies on it, as deep in it as its contacts give
/// way under the weight of a block. From a height of nothing at all the block of 1e6 Pa hops and never slides.
PrecisionScene without_distance(PrecisionScene scene);

}  // namespace skerry::profiling
