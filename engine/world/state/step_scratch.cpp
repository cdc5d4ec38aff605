#include "engine/world/state/step_scratch.h"

namespace skerry {

SolverSettings solver_settings(const Settings& settings, const Tuning& tuning) {
    SolverSettings solver;
    solver.method = settings.method;
    solver.friction = settings.friction;
    solver.warm_start = tuning.warm_start;
    solver.tolerance = settings.tolerance;
    solver.max_iterations = settings.max_iterations;
    solver.fixed_iterations = tuning.fixed_iterations;
    solver.relaxation = tuning.relaxation;
    solver.restitution_speed = tuning.restitution_speed;
    solver.recovery_speed = settings.recovery_speed;
    solver.certify_warm_start = tuning.certify_warm_start;
    solver.skip_separating = tuning.skip_separating;
    solver.frictionless_rows = tuning.frictionless_rows;
    solver.small_regions_in_lanes = tuning.small_regions_in_lanes;
    return solver;
}

StepParameters step_parameters(const Settings& settings, const Tuning& tuning) {
    StepParameters step;
    step.gravity = settings.gravity;
    step.contact_regions = settings.contact_regions;
    step.max_strain_step = tuning.max_strain_step;
    step.theta = settings.theta;
    step.takes_long_steps = settings.implicit_step > 0;
    step.sleep = {tuning.sleep_speed, settings.sleep && tuning.sleep_speed == 0, settings.sleep_time,
                  settings.gravity.norm()};
    step.collision.gravity = settings.gravity.norm();
    step.collision.use_budgets = tuning.contact_budgets;
    step.collision.continuous = settings.continuous_collision;
    step.solver = solver_settings(settings, tuning);
    // Solver tolerance for regions whose bodies are all still. It is so small that errors of the impulses do not keep a
    // pile of bodies awake. It costs little: in a pile at rest, the impulses of the last step already meet it.
    constexpr Real still_tolerance = 1e-5;
    if (step.sleep.own_limits) step.solver.still_tolerance = still_tolerance;
    return step;
}

}  // namespace skerry
