// What a user sets of the contact solver.
#pragma once

#include "components/options.h"
#include "components/types.h"

namespace skerry {

struct SolverSettings {
    SolverMethod method = SolverMethod::automatic;
    Friction friction = Friction::cone;
    WarmStart warm_start = WarmStart::on;
    Real tolerance = 1e-3;       // e_nat, docs/methods/errors.md 2
    Real still_tolerance = 1;    // of regions whose bodies are all still, where it is less (docs/methods/errors.md 7)
    Index max_iterations = 200;  // sweeps of a region
    // do exactly max_iterations sweeps: with pgs, separate and global are then bitwise the same
    bool fixed_iterations = false;
    Real relaxation = 1.0;          // over-relaxation of the sweep
    Real restitution_speed = 0.05;  // m/s: slower impacts do not bounce (docs/methods/contact.md 3.2)
    // beta: share of a negative gap taken back per step by the split impulse (docs/methods/contact.md 3.4)
    Real recovery = 0.15;
    Real recovery_speed = 0.5;              // m/s, cap of the recovery
    Index parallel_region_contacts = 2000;  // larger regions: coloured order, all workers within the region
    // Shortcuts (docs/methods/skipping.md 1, 2): off changes no result beyond the tolerance.
    bool certify_warm_start = true;  // no sweep where the warm start solves the region
    bool skip_separating = true;     // no impulse where no contact closes
    bool frictionless_rows = true;   // scalar rows where no contact of the region has friction
    // 2 to 12 contacts: eight regions side by side (method ags, cone, one coefficient)
    bool small_regions_in_lanes = true;

    bool operator==(const SolverSettings&) const = default;
};

/// Whether a region of the step is solved by accelerated sweeps (solve_ags), which the shortcuts have in forms of their
/// own.
inline bool sweeps_accelerated(const SolverSettings& settings) {
    return (settings.method == SolverMethod::ags || settings.method == SolverMethod::automatic) &&
           !settings.fixed_iterations;
}

}  // namespace skerry
