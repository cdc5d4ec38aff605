// Settings of a world that tests and measurements change and users do not.
#pragma once

#include "components/options.h"
#include "components/types.h"
#include "skerry/world.h"

namespace skerry {

/// Constants and shortcuts of the step. The defaults serve all scenes. Files save them with the settings.
struct Tuning {
    Real step_safety = 1;           // fraction of the stable step that is used, > 0 and <= 1
    Real max_strain_step = 0.2;     // a step that changes F of an element by more (Frobenius norm) is repeated shorter
    Real restitution_speed = 0.05;  // slower impacts do not bounce, whatever the restitution, >= 0 [m/s]
    // Above 0, a body is still if all its nodes are slower than this, whatever Settings::sleep says [m/s].
    Real sleep_speed = 0;
    // Skip searches of pairs that cannot have come close, and steps in which nothing moves. If off, everything is
    // searched in every step.
    bool contact_budgets = true;
    WarmStart warm_start = WarmStart::on;
    bool fixed_iterations = false;  // do exactly max_iterations sweeps
    Real relaxation = 1;            // relaxation factor of the sweeps, > 0 and < 2; only for methods that sweep
    // Shortcuts of the solver. Switching one off changes no result beyond the tolerance.
    bool certify_warm_start = true;  // no sweep if the impulses of the last step still solve a region
    bool skip_separating = true;     // no impulse in a region if none of its contacts closes
    bool frictionless_rows = true;   // one row per contact instead of three in a region without friction
    // regions of 2 to 12 contacts are solved eight at a time (method ags, friction cone)
    bool small_regions_in_lanes = true;

    bool operator==(const Tuning&) const = default;
};

/// Makes a world with settings that users do not have. Throws SceneError if a value is out of range.
World tuned_world(const Settings& settings, const Tuning& tuning);

}  // namespace skerry
