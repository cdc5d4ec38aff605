// Step of a free implicit body at large strain. The frame of the body rotates with the inertia of the deformed shape,
// and node velocities have no momentum and no angular momentum in this frame (docs/methods/implicit_bodies.md 8).
#pragma once

#include "systems/dynamics/implicit/body_rows.h"

namespace skerry {

/// Computes the node velocities of a step at large strain by Newton's method, by index of the node in the elimination
/// order. Returns false if Newton's method fails.
bool kick_large_free_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                          std::size_t r, Real h, Real theta, StiffBody& stiff, std::span<Vec3> out);

/// Computes the state at the end of a step in which strain is large at the start, during or at the end of the step.
/// Reads the displacements at the end of the step, and from out.velocity_next the node velocities that led to them.
/// Returns the damped energy [J].
Real end_large_free_step(const ImplicitBodies& bodies, const ImplicitLoads& loads, const ImplicitSpins& spins,
                         std::size_t r, Real h, Real theta, StiffBody& stiff, const ImplicitStrains& out);

/// Ends a step that was computed with linear elasticity, but at the end of which strain is large. Moments of inertia
/// and elastic energy become those of the deformed shape, and the node velocities lose the rigid motion of this shape.
/// Returns the energy that the body loses by this conversion [J], which the damped energy of the step does not contain.
Real become_large(const ImplicitBodies& bodies, const ImplicitSpins& spins, std::size_t r, Real h, StiffBody& stiff,
                  const ImplicitStrains& out);

/// Computes the principal moments of inertia, the principal axes and their rotation to the world. The body has its
/// present shape, or its rest shape if `large` is false. `displacement`: by node [m]; `from_mesh`: rotation from the
/// frame of the mesh to the world.
void follow_shape(std::span<const Vec3> displacement, bool large, const Mat3& from_mesh, StiffBody& stiff,
                  Vec3& moments, Mat3& axes, Mat3& rotation);

}  // namespace skerry
