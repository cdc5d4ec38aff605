// Settings of a world for tests and measurements. Users cannot change them.
#pragma once

#include "components/options.h"
#include "components/types.h"
#include "skerry/world.h"

namespace skerry {

/// Constants of the step, and switches for its shortcuts. The defaults suit all scenes. Saved files contain these
/// values.
struct Tuning {
    Real step_safety = 1;  // largest step length as a fraction of the stable step, > 0 and <= 1
    // Largest change of the deformation gradient F of an element in one step (Frobenius norm). A step that changes F by
    // more is repeated with a shorter length.
    Real max_strain_step = 0.2;
    Real restitution_speed = 0.05;  // impacts slower than this do not bounce, >= 0 [m/s]
    // A body counts as still if all of its nodes are slower than this [m/s]. A value above 0 replaces the criterion of
    // Settings::sleep, and lets bodies sleep even if Settings::sleep is false.
    Real sleep_speed = 0;
    // If true, pairs whose objects have moved too little to come close are not searched, and steps in which nothing
    // moves are skipped. If false, every step searches all pairs, and no step is skipped.
    bool contact_budgets = true;
    WarmStart warm_start = WarmStart::on;
    bool fixed_iterations = false;  // true: the solver always makes max_iterations sweeps
    Real relaxation = 1;            // relaxation factor of solver methods that sweep, > 0 and < 2
    // Shortcuts that the contact solver uses where possible. Switching a shortcut off changes the impulses by no more
    // than the tolerance.
    bool certify_warm_start = true;  // skips the solve of a region if the impulses of the last step are accurate enough
    bool skip_separating = true;     // sets the impulses of a region to zero if none of its contacts closes
    bool frictionless_rows = true;   // solves one row per contact instead of three in a region without friction
    // solves eight regions of 2 to 12 contacts at once in vector lanes; only with the method `ags` or `automatic`, the
    // friction cone, and equal static and dynamic friction
    bool small_regions_in_lanes = true;

    bool operator==(const Tuning&) const = default;
};

/// Replaces backend and number of threads by those that `load_settings` gives. Throws SceneError if they are out of
/// range.
void use(const LoadSettings& load_settings, Settings& settings);
/// Makes a world with the given tuning. Throws SceneError if a value is out of range.
World tuned_world(const Settings& settings, const Tuning& tuning);

}  // namespace skerry
