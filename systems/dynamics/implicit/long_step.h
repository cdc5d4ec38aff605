// Long steps of implicit bodies, during which other bodies take several short steps (docs/methods/implicit_bodies.md
// 9).
#pragma once

#include <span>

#include "systems/dynamics/implicit/body_rows.h"
#include "systems/dynamics/implicit/move_implicit_bodies.h"

namespace skerry {

/// True if a body takes long steps: long steps are in use, no attachment holds the body, and its strain is small.
bool takes_long_steps(const ImplicitBodies& bodies, const ImplicitTimes& times, std::size_t r);

/// Computes the node velocities in this short step before its contacts are known: the rates at which the displacements
/// change, by index in the elimination order [m/s]. Begins a long step if the body is in none. Returns false if the
/// matrix of the long step cannot be factored.
bool kick_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                       const ImplicitTimes& times, StiffBody& stiff, std::span<Vec3> elastic_force,
                       std::span<Vec3> out);
/// Prepares a sleeping body as if a long step started with this short step. The response of the body to contacts of
/// this short step then uses the matrix of the long step and LongStep::weight = 1, the weight in the first short step.
void rest_in_long_step(const ImplicitTimes& times, StiffBody& stiff);

/// Computes displacements and velocities at the end of the short step. If the long step ends with it, the next long
/// step starts from these values. `contact_velocity`: node velocities that the contacts of this step add, by index in
/// the elimination order [m/s].
///
/// Returns the damped energy, without the change of energy that a change to large strain at the end of the step causes
/// (become_large()) [J].
Real strain_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                         const ImplicitTimes& times, StiffBody& stiff, std::span<const Vec3> contact_velocity,
                         const ImplicitStrains& out);

}  // namespace skerry
