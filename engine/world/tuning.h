// Settings of a world that only tests and measurements change. Users cannot reach them.
#pragma once

#include "components/options.h"
#include "components/types.h"
#include "skerry/world.h"

namespace skerry {

/// Constants of the step, and switches for its shortcuts. The defaults suit all scenes. Saved files contain these
/// values.
struct Tuning {
    Real step_safety = 1;  // upper limit of the step length as a fraction of the stable step, > 0 and <= 1
    // Upper limit of the change of the deformation gradient F of an element in one step (Frobenius norm). A step that
    // changes F by more is repeated with a shorter length.
    Real max_strain_step = 0.2;
    Real restitution_speed = 0.05;  // impacts slower than this do not rebound, >= 0 [m/s]
    // A body counts as still if all of its nodes are slower than this [m/s]. If the value is above 0, bodies can sleep
    // even if Settings::sleep is false. If it is 0, the engine uses its own criterion, and bodies sleep only if
    // Settings::sleep is true.
    Real sleep_speed = 0;
    // If true, pairs whose objects have moved too little to come close are not searched, and steps in which nothing
    // moves are skipped. If false, every step searches all pairs, and no step is skipped.
    bool contact_budgets = true;
    WarmStart warm_start = WarmStart::on;
    bool fixed_iterations = false;  // true: the solver always makes max_iterations sweeps
    Real relaxation = 1;            // relaxation factor of solver methods that sweep over the contacts, > 0 and < 2
    // Shortcuts that the contact solver uses where possible. Without a shortcut, the impulses differ by no more than
    // the tolerance of the solver.
    bool certify_warm_start = true;  // keeps the impulses of the last step if they are accurate enough for a region
    bool skip_separating = true;     // sets the impulses of a region to zero if none of its gaps closes
    bool frictionless_rows = true;   // computes only normal impulses in a region without friction
    // Solves eight regions of 2 to 12 contacts at once, one in each SIMD lane. This needs the method `ags` or
    // `automatic`, the friction cone, and equal static and dynamic friction.
    bool small_regions_in_lanes = true;

    bool operator==(const Tuning&) const = default;
};

/// Replaces the backend and the number of threads in `settings` by those that `load_settings` gives. Throws SceneError
/// if they are out of range.
void use(const LoadSettings& load_settings, Settings& settings);
/// Makes a world with the given tuning. Throws SceneError if a value is out of range.
World tuned_world(const Settings& settings, const Tuning& tuning);

}  // namespace skerry
