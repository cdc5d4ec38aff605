// How long one body has been still by the engine's own limits (docs/methods/skipping.md 3.1).
#pragma once

#include <span>

#include "systems/dynamics/motion/update_sleep.h"

namespace skerry {

/// What makes a body still where the user gives no speed.
namespace own_sleep_limits {
/// No node is as fast as this times sqrt(gravity times the mean edge),
inline constexpr Real speed = 0.01;
/// none comes further in half of the time than this part of the mean edge,
inline constexpr Real drift = 3e-3;
/// and none this times as far as in the half before: what begins to slide, to fall or to buckle does.
inline constexpr Real growth = 2;
/// Of the mean edge: less is not compared.
inline constexpr Real noise = 2e-5;
/// Of the weight of each node: what its forces, but for those of damping, miss balance by.
inline constexpr Real imbalance = 1e-3;
/// Of what the shape is away from that at rest, or else of the mean edge: what the shape changes by in half of the
/// time.
inline constexpr Real shape_change = 8e-3, shape_noise = 1e-4;
/// Of what the shape is away from that at rest: what is left of a change that goes one way and becomes slower.
inline constexpr Real creep = 3e-3;
/// Looks at the drift in each half.
inline constexpr int looks = 8;
}  // namespace own_sleep_limits

/// Greatest distance between points of one list and those of another after the rigid motion that brings them closest
/// in the mean of squares, m. Zero for fewer than two.
Real shape_distance(std::span<const Vec3> points, std::span<const Vec3> others);

/// Adds `h` to the time for which the body has been still, or begins anew: from zero where it is not still, from half
/// of the time where it is, but not yet where it will come to stand.
void watch_stillness(const RestInputs& bodies, const SleepSettings& settings, std::size_t body, Real h,
                     const RestOutputs& state);

}  // namespace skerry
