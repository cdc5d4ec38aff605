// Step of large strain of a free body, which no attachment holds. Its frame turns with the inertia of its shape, and
// its nodes have no momenta in the frame (docs/methods/implicit_bodies.md 8).
#pragma once

#include "systems/dynamics/implicit/of_body.h"

namespace skerry {

/// Computes the velocities of the step by Newton's method, by place. Returns false if none are found.
bool kick_large_free_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                          std::size_t r, Real h, Real theta, StiffBody& stiff, std::span<Vec3> out);

/// Computes the state at the end of a step in which strain is or was large. Reads the velocities of the step's
/// displacement (`out.velocity_next`) and the displacements at its end. Returns the damped energy [J].
Real end_large_free_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                         std::size_t r, Real h, Real theta, StiffBody& stiff, const ImplicitStrains& out);

/// Converts the end state of a step of small strain, already written, to large strain. Returns the energy damped in
/// addition to that of the step with linear elasticity [J].
Real become_large(const ImplicitBodies& bodies, const ImplicitSpins& spins, std::size_t r, Real h, StiffBody& stiff,
                  const ImplicitStrains& out);

/// Computes principal moments, axes and rotation of a body in its present shape, or at rest if it is not `large`.
/// `displacement`: by node [m]; `from_mesh`: frame of the mesh to the world.
void follow_shape(std::span<const Vec3> displacement, bool large, const Mat3& from_mesh, StiffBody& stiff,
                  Vec3& moments, Mat3& axes, Mat3& rotation);

}  // namespace skerry
