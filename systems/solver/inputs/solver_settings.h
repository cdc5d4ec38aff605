// User settings of the contact solver.
#pragma once

#include "components/options.h"
#include "components/types.h"

namespace skerry {

struct SolverSettings {
    SolverMethod method = SolverMethod::automatic;
    Friction friction = Friction::cone;
    WarmStart warm_start = WarmStart::on;
    Real tolerance = 1e-3;  // e_nat, docs/methods/errors.md 2
    // Used instead in regions whose bodies are all still, if smaller (docs/methods/errors.md 7).
    Real still_tolerance = 1;
    Index max_iterations = 200;  // limit of sweeps per region
    // Do exactly max_iterations sweeps. With pgs, separate and global regions then give bitwise equal results.
    bool fixed_iterations = false;
    Real relaxation = 1.0;          // over-relaxation of the sweep
    Real restitution_speed = 0.05;  // slower impacts do not bounce (docs/methods/contact.md 3.2) [m/s]
    // beta: share of a negative gap that the split impulse corrects per step (docs/methods/contact.md 3.4).
    Real recovery = 0.15;
    Real recovery_speed = 0.5;  // upper bound of the recovery speed [m/s]
    // Regions from this size on are solved one by one in their coloured order by all workers.
    Index parallel_region_contacts = 2000;
    // Shortcuts (docs/methods/skipping.md 1, 2). Switching one off changes results only within the tolerance.
    bool certify_warm_start = true;  // skip the sweeps if the warm start solves the region
    bool skip_separating = true;     // return zero impulses if no contact closes
    bool frictionless_rows = true;   // scalar rows if no contact of the region has friction
    // Regions of 2 to 12 contacts: solve eight in SIMD lanes (method ags, cone, equal static and dynamic friction).
    bool small_regions_in_lanes = true;

    bool operator==(const SolverSettings&) const = default;
};

/// True if regions are solved by accelerated sweeps (solve_ags). The shortcuts have their own versions of that method.
inline bool sweeps_accelerated(const SolverSettings& settings) {
    return (settings.method == SolverMethod::ags || settings.method == SolverMethod::automatic) &&
           !settings.fixed_iterations;
}

}  // namespace skerry
