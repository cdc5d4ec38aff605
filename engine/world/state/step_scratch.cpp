#include "engine/world/state/step_scratch.h"

namespace skerry {

SolverSettings solver_settings(const Settings& settings) {
    SolverSettings solver;
    solver.method = settings.method;
    solver.friction = settings.friction;
    solver.warm_start = settings.warm_start;
    solver.tolerance = settings.tolerance;
    solver.max_iterations = settings.max_iterations;
    solver.fixed_iterations = settings.fixed_iterations;
    solver.relaxation = settings.relaxation;
    solver.restitution_speed = settings.restitution_speed;
    solver.recovery_speed = settings.recovery_speed;
    solver.certify_warm_start = settings.certify_warm_start;
    solver.skip_separating = settings.skip_separating;
    solver.frictionless_rows = settings.frictionless_rows;
    solver.small_regions_in_lanes = settings.small_regions_in_lanes;
    return solver;
}

StepParameters step_parameters(const Settings& settings) {
    StepParameters step;
    step.gravity = settings.gravity;
    step.contact_regions = settings.contact_regions;
    step.max_strain_step = settings.max_strain_step;
    step.theta = settings.theta;
    step.takes_long_steps = settings.implicit_step > 0;
    step.sleep = {settings.sleep_speed, settings.sleep && settings.sleep_speed == 0, settings.sleep_time,
                  settings.gravity.norm()};
    step.collision.gravity = settings.gravity.norm();
    step.collision.use_budgets = settings.contact_budgets;
    step.collision.continuous = settings.continuous_collision;
    step.solver = solver_settings(settings);
    // small enough for a pile that looks still to come to rest, and no smaller than a warm start reaches at rest anyway
    constexpr Real still_tolerance = 1e-5;
    if (step.sleep.own_limits) step.solver.still_tolerance = still_tolerance;
    return step;
}

}  // namespace skerry
