// Static equilibrium: where the bodies of a world come to rest under their loads (docs/methods/loads.md 3).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "components/handle.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

class World;

/// Settings of relax().
struct RelaxSettings {
    // Largest out-of-balance force of a body at rest, relative to the sum of the forces that act on it, > 0 and < 1.
    Real tolerance = 1e-3;
    int max_steps = 100000;  // largest number of steps for each share of the loads, >= 1
    // 1: the loads act as a whole. More: forces, tractions and accelerations of loads and of World::set_loads, and
    // prescribed pressures and tensions (of cables and fibres), grow from zero in this number of equal load steps, each
    // of which ends in equilibrium. If a load step finds none, it is halved, at most six times.
    int load_steps = 1;
};

/// Result of relax(): whether an equilibrium was found, and the body that is farthest from it.
struct RelaxReport {
    bool converged = false;  // whether all bodies are in equilibrium
    Real load = 0;           // share of the loads in the last equilibrium that was found: 1 if converged
    // The largest out-of-balance force of a body in the last step, relative to the sum of the magnitudes of the
    // weights, loads and contact forces on its nodes.
    Real residual = 0;
    std::optional<BodyHandle> worst{};  // the body with the force `residual`; missing if no body can move
    std::string worst_name;             // name of this body
    Real speed = 0;                     // largest speed of a node of the body `worst` in the last step [m/s]
    int steps = 0;                      // number of steps
    Real seconds = 0;                   // sum of the step lengths [s]
    std::string message;                // reason why a step could not be completed; otherwise empty
};

/// Moves the bodies of a world to a static equilibrium by dynamic relaxation with kinetic damping (Day 1965; Cundall
/// 1976): ordinary steps, in which a body loses its velocities each time its kinetic energy has passed a maximum.
/// Contacts and friction are those of the steps. All bodies start without velocities, and end without them. The result
/// may depend on the path of this motion, where friction or bistable shapes permit several equilibria.
///
/// Time does not advance: values over time and prescribed motions stay at their present values, colliders and
/// attachments do not move, gas does not flow, cables driven by a rate keep their greatest length, ties do not break,
/// and the report of the run does not count the steps. Viscous stress is fully relaxed at the end. If the residual
/// stays above the tolerance, for example of a sliding body, or if a step cannot be completed, the world does not
/// change. Throws the errors of World::settle_start(), and SceneError if a setting is out of range.
///
/// Calls `go_on`, if given, with the report so far after each step; if it returns false, the relaxation ends and the
/// world does not change.
RelaxReport relax(World& world, const RelaxSettings& settings = {},
                  const std::function<bool(const RelaxReport&)>& go_on = {});

}  // namespace skerry
#pragma GCC visibility pop
