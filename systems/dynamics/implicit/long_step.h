// Steps of implicit bodies that are longer than those of other bodies (docs/methods/implicit_bodies.md 9).
#pragma once

#include <span>

#include "systems/dynamics/implicit/move_implicit_bodies.h"
#include "systems/dynamics/implicit/of_body.h"

namespace skerry {

/// True if a body takes long steps: it is free and of small strain, and there are long steps.
bool takes_long_steps(const ImplicitBodies& bodies, const ImplicitTimes& times, std::size_t r);

/// Computes the velocities of the displacement in this short step without its contacts, by place. Begins a long step if
/// the body is in none. Returns false if its matrix cannot be factored.
bool kick_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                       const ImplicitTimes& times, StiffBody& stiff, std::span<Vec3> elastic_force,
                       std::span<Vec3> out);
/// Sets a body at rest to the state at the start of a long step, which its contacts then see.
void rest_in_long_step(const ImplicitTimes& times, StiffBody& stiff);

/// Computes displacements and velocities at the end of the short step; the body continues with them if its long step
/// ends here. `given`: velocities of displacements that its contacts gave, by place [m/s]. Returns the damped energy
/// [J], without the jump of energy where strain has become large.
Real strain_in_long_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r,
                         const ImplicitTimes& times, StiffBody& stiff, std::span<const Vec3> given,
                         const ImplicitStrains& out);

}  // namespace skerry
