// Steps of implicit bodies that are longer than those of the others (docs/methods/implicit_bodies.md 9).
#pragma once

#include <span>

#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/implicit/of_body.h"

namespace skerry {

/// Whether a body goes on by long steps: it is free, and of small strain.
bool takes_long_steps(const ImplicitBodies& bodies, const ImplicitTimes& times, std::size_t r);

/// The velocities of the displacement in this short step, without its contacts; by place. Begins a long step where the
/// body is in none. Returns false where there is no factor.
bool kick_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                       const ImplicitTimes& times, StiffBody& stiff, std::span<Vec3> elastic_force,
                       std::span<Vec3> out);
/// A body at rest: what touches it finds it as at the start of a long step.
void rest_in_long_step(const ImplicitTimes& times, StiffBody& stiff);

/// Displacements and velocities at the end of the short step: those that the body goes on with if its long step ends
/// here. `given`: m/s, by place, what its contacts gave to the velocity of displacements. Returns what was damped, J,
/// but for what energy jumps by where strain has become large.
Real strain_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                         const ImplicitTimes& times, StiffBody& stiff, std::span<const Vec3> given,
                         const ImplicitStrains& out);

}  // namespace skerry
