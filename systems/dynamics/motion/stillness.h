// Measures for how long a body has been still, if the engine chooses the limits (docs/methods/skipping.md 3.1).
#pragma once

#include <span>

#include "systems/dynamics/motion/update_sleep.h"

namespace skerry {

/// Limits for a still body. They are used unless the user sets a sleep speed.
namespace own_sleep_limits {
/// Upper limit of the speed of all nodes, as a fraction of sqrt(gravity times the mean edge).
inline constexpr Real speed = 0.01;
/// Upper limit of the drift, which is the largest displacement of a node in half of the sleep time, as a fraction of
/// the mean edge.
inline constexpr Real drift = 3e-3;
/// Upper limit of the ratio of the drift to the drift in the previous half of the sleep time. Bodies that begin to
/// slide, fall or buckle exceed it.
inline constexpr Real growth = 2;
/// Noise level of displacements, as a fraction of the mean edge. The limits of growing drift, steady motion and change
/// of shape do not apply below this level.
inline constexpr Real noise = 2e-5;
/// Largest imbalance of the forces on a node, as a fraction of its weight. Damping forces are not counted.
inline constexpr Real imbalance = 1e-3;
/// Largest change of the shape in half of the sleep time. The limit is the larger of `shape_change` times the distance
/// from the rest shape and `shape_noise` times the mean edge.
inline constexpr Real shape_change = 8e-3, shape_noise = 1e-4;
/// Largest remaining creep of the shape, as a fraction of the distance from the rest shape. Creep is a change in one
/// direction that slows down.
inline constexpr Real creep = 3e-3;
/// Number of measurements of the drift in each half of the sleep time.
inline constexpr int measurements = 8;
}  // namespace own_sleep_limits

/// Greatest distance between corresponding points of two lists. Before the comparison one list is moved by the rigid
/// motion that minimises the sum of squared distances [m]. Zero for fewer than two points.
Real shape_distance(std::span<const Vec3> points, std::span<const Vec3> others);

/// Adds `h` to the time for which a body has been still. Resets this time to zero if the body is not still, and to half
/// of the sleep time if the body is still but not yet at its final position.
void watch_stillness(const RestInputs& bodies, const SleepSettings& settings, std::size_t body, Real h,
                     const RestOutputs& state);

}  // namespace skerry
