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
    // Upper limit of RelaxReport::residual in equilibrium, > 0 and < 1. It must hold for all bodies in 10 successive
    // steps, because in a vibration the forces balance for a moment, too.
    Real tolerance = 1e-3;
    int max_steps = 100000;  // largest number of time steps for each load step, >= 1
    // Number of load steps, >= 1. The loads grow from zero in this number of equal load steps, each of which ends in
    // equilibrium. With 1, they act in full from the start.
    // - Growing loads: forces, tractions and accelerations of loads, forces of World::set_loads, prescribed pressures,
    //   and tensions of cables and fibres. Weight and drag always act in full.
    // - A load step that finds no equilibrium is halved, at most six times.
    int load_steps = 1;
};

/// Result of relax(): whether an equilibrium was found, and the body that is farthest from it.
struct RelaxReport {
    bool converged = false;  // whether all bodies are in equilibrium
    Real load = 0;           // share of the loads in the last equilibrium found: 1 if converged, 0 if none was found
    // Out-of-balance forces of the body `worst` in the last step: sum of their magnitudes over its nodes, divided by
    // the sum of the magnitudes of the weights, loads and contact forces on its nodes.
    Real residual = 0;
    std::optional<BodyHandle> worst{};  // the body with the largest residual; missing if no body can move
    std::string worst_name;             // name of the body `worst`
    Real speed = 0;                     // largest speed of a node of the body `worst` in the last step [m/s]
    int steps = 0;                      // number of steps
    Real seconds = 0;                   // sum of the step lengths [s]
    std::string message;                // reason why a step could not be completed; otherwise empty
};

/// Moves the bodies of a world to a static equilibrium by dynamic relaxation with kinetic damping (Day 1965; Cundall
/// 1976; docs/methods/loads.md 3). The function takes ordinary steps, with contact and friction. Each time the kinetic
/// energy of a body has passed a maximum, its velocities are set to zero; joined bodies are stopped together.
///
/// - Start and end: all bodies are without velocities. Viscous stress is fully relaxed at the end.
/// - Several equilibria: friction or bistable shapes can permit them; the motion during the steps then decides which
///   one is found.
/// - Time does not advance: values over time and prescribed motions stay at their present values, colliders and
///   attachments do not move, gas does not flow, cables with a prescribed rate are not drawn in, ties do not break, and
///   the report of the run does not count the steps.
/// - Failure: the world does not change if no equilibrium is found within max_steps, for example because a body slides,
///   or if a step cannot be completed.
/// - Errors: those of World::settle_start(), and SceneError if a setting is out of range.
/// - `go_on`, if given, is called with the report so far after each step. If it returns false, the relaxation ends and
///   the world does not change.
RelaxReport relax(World& world, const RelaxSettings& settings = {},
                  const std::function<bool(const RelaxReport&)>& go_on = {});

}  // namespace skerry
#pragma GCC visibility pop
