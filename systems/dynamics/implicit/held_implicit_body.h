// The step of an implicit body that an attachment holds: its frame is led, its nodes have all of their velocity
// (docs/methods/implicit_bodies.md 7).
#pragma once

#include "systems/dynamics/implicit/of_body.h"

namespace skerry {

/// How the frame of the mesh moves in this step.
struct LedFrame {
    bool stands;      // it does not move at all, as far as this step goes
    Mat3 turn_start;  // frame of the mesh at the start of the step to the world
    Mat3 turn;        // the same at its end
    Mat3 across;      // frame of the start to that of the end
    Vec3 shift;       // m, where the centre of the start is from that of the end, in the frame of the end

    LedFrame(const ImplicitBodies& bodies, std::size_t r, Real h);

    /// m, the displacement at the end of a node that keeps its place in the world. `arm`: of its rest position from the
    /// centre.
    Vec3 carried(const Vec3& arm, const Vec3& displacement) const {
        return stands ? displacement : Vec3(across * (arm + displacement) - arm + shift);
    }
};

/// As kick_implicit_bodies, of one body, and its `velocity_next` in the frame of the start.
void kick_held_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r, Real h, Real theta,
                    StiffBody& stiff, const ImplicitKicks& out);

/// As strain_implicit_bodies, of one body. Returns what it damped, less what its hold gave by its moment, J.
Real strain_held_body(const ImplicitBodies& bodies, std::size_t r, Real h, Real kick, Real theta, StiffBody& stiff,
                      const ImplicitStrains& out);

/// As drift_implicit_bodies, of one body.
void drift_held_body(const ImplicitBodies& bodies, std::size_t r, Real seconds, std::span<Vec3> displacement_next,
                     std::span<Vec3> velocity_next);

}  // namespace skerry
