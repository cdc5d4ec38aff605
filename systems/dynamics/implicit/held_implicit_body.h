// Step of an implicit body that an attachment holds. The motion of its frame is prescribed, and the velocities of its
// nodes include this motion (docs/methods/implicit_bodies.md 7).
#pragma once

#include "systems/dynamics/implicit/body_rows.h"

namespace skerry {

/// Prescribed motion of the mesh frame of a held body in this step.
struct HeldFrame {
    bool is_still;    // true if the frame does not move in this step
    Mat3 turn_start;  // rotation from the frame of the mesh to the world at the start of the step
    Mat3 turn;        // rotation from the frame of the mesh to the world at the end of the step
    Mat3 across;      // rotation from the frame at the start to the frame at the end of the step
    Vec3 shift;       // centre at the start minus centre at the end, in the frame at the end [m]

    HeldFrame(const ImplicitBodies& bodies, std::size_t r, Real h);

    /// Displacement at the end of the step of a node that does not move in the world, in the frame at that time [m].
    /// `displacement`: in the frame at the start [m]. `arm`: rest position of the node relative to the centre [m].
    Vec3 carried(const Vec3& arm, const Vec3& displacement) const {
        return is_still ? displacement : Vec3(across * (arm + displacement) - arm + shift);
    }
};

/// Computes the node velocities of one held body in the step without its contacts, for kick_implicit_bodies. Writes
/// out.velocity_next in the frame of the mesh at the start of the step.
void kick_held_body(const ImplicitBodies& bodies, const ImplicitLoads& loads, std::size_t r, Real h, Real theta,
                    StiffBody& stiff, const ImplicitKicks& out);

/// Computes velocities and displacements of one held body at the end of the step, for strain_implicit_bodies. `kick`:
/// time for which loads act on explicit bodies (ImplicitLoads) [s]. Returns the damped energy minus the work of the
/// moment with which the attachment acts on the body [J].
Real strain_held_body(const ImplicitBodies& bodies, std::size_t r, Real h, Real kick, Real theta, StiffBody& stiff,
                      const ImplicitStrains& out);

/// Moves one held body for the time `seconds` at its present velocities, for drift_implicit_bodies.
void drift_held_body(const ImplicitBodies& bodies, std::size_t r, Real seconds, std::span<Vec3> displacement_next,
                     std::span<Vec3> velocity_next);

}  // namespace skerry
