// The step of large strain of a body that nothing holds: its frame turns by the inertia of its shape, its nodes have no
// momenta in it (docs/methods/implicit_bodies.md 8).
#pragma once

#include "systems/dynamics/implicit/of_body.h"

namespace skerry {

/// Velocities of the step by Newton's method, by place.
bool kick_large_free_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                          std::size_t r, Real h, Real theta, StiffBody& stiff, std::span<Vec3> out);

/// From velocities of the step's displacement (`out.velocity_next`) and displacements at its end to what is there then,
/// where strain is large or was. Returns what it damped, J.
Real end_large_free_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                         std::size_t r, Real h, Real theta, StiffBody& stiff, const ImplicitStrains& out);

/// Where strain was small in a step whose end is written: the same, beside what was damped with linear elasticity.
Real become_large(const ImplicitBodies& bodies, const ImplicitSpins& spins, std::size_t r, Real h, StiffBody& stiff,
                  const ImplicitStrains& out);

/// How a body of large strain turns in the shape that it has by now.
void follow_shape(std::span<const Vec3> displacement, bool large, const Mat3& from_mesh, StiffBody& stiff,
                  Vec3& moments, Mat3& axes, Mat3& rotation);

}  // namespace skerry
