// Step of an implicit body held by an attachment: its frame is prescribed, and its nodes have the whole velocity
// (docs/methods/implicit_bodies.md 7).
#pragma once

#include "systems/dynamics/implicit/of_body.h"

namespace skerry {

/// Motion of the frame of the mesh in this step.
struct LedFrame {
    bool stands;      // true if the frame does not move in this step
    Mat3 turn_start;  // frame of the mesh to the world at the start of the step
    Mat3 turn;        // frame of the mesh to the world at the end of the step
    Mat3 across;      // frame of the start to the frame of the end
    Vec3 shift;       // centre of the start relative to that of the end, in the frame of the end [m]

    LedFrame(const ImplicitBodies& bodies, std::size_t r, Real h);

    /// Displacement at the end of the step of a node that keeps its place in the world [m]. `arm`: its rest position
    /// relative to the centre [m].
    Vec3 carried(const Vec3& arm, const Vec3& displacement) const {
        return stands ? displacement : Vec3(across * (arm + displacement) - arm + shift);
    }
};

/// Version of kick_implicit_bodies for one held body. Its `velocity_next` is in the frame of the start.
void kick_held_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r, Real h, Real theta,
                    StiffBody& stiff, const ImplicitKicks& out);

/// Version of strain_implicit_bodies for one held body. Returns the damped energy less the work of the moment of its
/// hold [J].
Real strain_held_body(const ImplicitBodies& bodies, std::size_t r, Real h, Real kick, Real theta, StiffBody& stiff,
                      const ImplicitStrains& out);

/// Version of drift_implicit_bodies for one held body.
void drift_held_body(const ImplicitBodies& bodies, std::size_t r, Real seconds, std::span<Vec3> displacement_next,
                     std::span<Vec3> velocity_next);

}  // namespace skerry
