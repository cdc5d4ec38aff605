// User settings of the contact solver.
#pragma once

#include "components/options.h"
#include "components/types.h"

namespace skerry {

struct SolverSettings {
    SolverMethod method = SolverMethod::automatic;
    Friction friction = Friction::cone;
    WarmStart warm_start = WarmStart::on;
    Real tolerance = 1e-3;  // relative error e_nat at which sweeps end (docs/methods/errors.md 2)
    // Tolerance for regions whose bodies did not move in the last step. It has no effect unless it is smaller than
    // `tolerance` (docs/methods/errors.md 7).
    Real still_tolerance = 1;
    Index max_iterations = 200;  // upper limit on the number of sweeps per region
    // If true, each region does exactly max_iterations sweeps. With method pgs, results are then bitwise independent of
    // the division into regions.
    bool fixed_iterations = false;
    Real relaxation = 1.0;          // over-relaxation factor of the sweeps
    Real restitution_speed = 0.05;  // impacts slower than this do not bounce (docs/methods/contact.md 3.2) [m/s]
    // beta: fraction of a negative gap that the split impulse corrects per step (docs/methods/contact.md 3.4).
    Real recovery = 0.15;
    Real recovery_speed = 0.5;  // upper bound of the speed at which the split impulse corrects a gap [m/s]
    // Regions with at least this many contacts are solved one after the other, each by a team of workers. The workers
    // follow a colouring of the contacts (colour_contacts.h).
    Index parallel_region_contacts = 2000;
    // Switches of shortcuts (docs/methods/skipping.md 1, 2). If a shortcut is switched off, the results change only
    // within the tolerance.
    bool certify_warm_start = true;  // skip the sweeps if the error of the warm start is within the tolerance
    bool skip_separating = true;     // return zero impulses if no contact of the region closes
    bool frictionless_rows = true;   // solve only for normal impulses if no contact of the region has friction
    // Solve regions of 2 to 12 contacts in SIMD lanes, eight regions at a time. This needs method ags or automatic, the
    // friction cone, and equal static and dynamic friction.
    bool small_regions_in_lanes = true;

    bool operator==(const SolverSettings&) const = default;
};

/// True if regions are solved by accelerated sweeps (solve_ags). The shortcuts frictionless_rows and
/// small_regions_in_lanes require these sweeps.
inline bool sweeps_accelerated(const SolverSettings& settings) {
    return (settings.method == SolverMethod::ags || settings.method == SolverMethod::automatic) &&
           !settings.fixed_iterations;
}

}  // namespace skerry
