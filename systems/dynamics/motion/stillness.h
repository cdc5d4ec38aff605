// Time for which one body has been still by the engine's own limits (docs/methods/skipping.md 3.1).
#pragma once

#include <span>

#include "systems/dynamics/motion/update_sleep.h"

namespace skerry {

/// Limits for a still body where the user gives no speed.
namespace own_sleep_limits {
/// All nodes are slower than this times sqrt(gravity times the mean edge).
inline constexpr Real speed = 0.01;
/// No node moves further in half of the sleep time than this part of the mean edge.
inline constexpr Real drift = 3e-3;
/// No node moves further than this times its way in the half before. Bodies that begin to slide, fall or buckle do.
inline constexpr Real growth = 2;
/// Movements below this part of the mean edge are not compared.
inline constexpr Real noise = 2e-5;
/// Largest imbalance of the forces on a node, without those of damping, as a part of its weight.
inline constexpr Real imbalance = 1e-3;
/// Largest change of the shape in half of the sleep time: `shape_change` as a part of its distance from the shape at
/// rest, or `shape_noise` as a part of the mean edge, whichever is larger.
inline constexpr Real shape_change = 8e-3, shape_noise = 1e-4;
/// Largest rest of a change that goes one way and slows down, as a part of the distance from the shape at rest.
inline constexpr Real creep = 3e-3;
/// Number of measurements of the drift in each half.
inline constexpr int looks = 8;
}  // namespace own_sleep_limits

/// Greatest distance between points of one list and those of another after the rigid motion that brings them closest in
/// the mean of squares [m]. Zero for fewer than two points.
Real shape_distance(std::span<const Vec3> points, std::span<const Vec3> others);

/// Adds `h` to the time for which the body has been still, or restarts it: from zero if the body is not still, from
/// half of the sleep time if it is, but not yet at its final position.
void watch_stillness(const RestInputs& bodies, const SleepSettings& settings, std::size_t body, Real h,
                     const RestOutputs& state);

}  // namespace skerry
