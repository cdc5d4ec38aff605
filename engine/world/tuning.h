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
    // Speed below which all nodes of a body must be for the body to count as still, whatever Settings::sleep is [m/s].
    // With 0 this criterion is not used.
    Real sleep_speed = 0;
    // If true, pairs whose objects have moved too little to come close are not searched, and steps in which nothing
    // moves are skipped. If false, every step searches all pairs.
    bool contact_budgets = true;
    WarmStart warm_start = WarmStart::on;
    bool fixed_iterations = false;  // true: the solver always makes max_iterations sweeps
    Real relaxation = 1;            // relaxation factor of solver methods that sweep, > 0 and < 2
    // Shortcuts that the contact solver uses where possible. Switching a shortcut off changes the impulses by no more
    // than the tolerance.
    bool certify_warm_start = true;  // skips a region if the impulses of the last step solve it accurately enough
    bool skip_separating = true;     // sets the impulses of a region to zero if none of its contacts closes
    bool frictionless_rows = true;   // solves one row per contact instead of three in a region without friction
    // solves eight regions of 2 to 12 contacts in parallel in vector lanes (method ags, friction cone)
    bool small_regions_in_lanes = true;

    bool operator==(const Tuning&) const = default;
};

/// Replaces backend and number of threads by those that `wanted` gives. Throws SceneError if they are out of range.
void use(const LoadSettings& wanted, Settings& settings);
/// Makes a world with the given tuning. Throws SceneError if a value is out of range.
World tuned_world(const Settings& settings, const Tuning& tuning);

}  // namespace skerry
