#include "engine/world/state/step_scratch.h"

namespace skerry {

StepParameters step_parameters(const Settings& settings) {
    StepParameters step;
    step.gravity = settings.gravity;
    step.integrator = settings.integrator;
    step.contact_regions = settings.contact_regions;
    step.max_strain_step = settings.max_strain_step;
    step.sleep = {settings.sleep_speed, settings.sleep_time};
    step.collision.gravity = settings.gravity.norm();
    step.collision.use_budgets = settings.contact_budgets;
    // forward Euler drifts with velocities that no contact has seen: there is nothing to hold it to
    step.collision.continuous = settings.continuous_collision && settings.integrator != Integrator::forward_euler;
    step.solver.method = settings.method;
    step.solver.friction = settings.friction;
    step.solver.warm_start = settings.warm_start;
    step.solver.tolerance = settings.tolerance;
    step.solver.max_iterations = settings.max_iterations;
    step.solver.fixed_iterations = settings.fixed_iterations;
    step.solver.relaxation = settings.relaxation;
    step.solver.restitution_speed = settings.restitution_speed;
    step.solver.recovery_speed = settings.recovery_speed;
    step.solver.certify_warm_start = settings.certify_warm_start;
    step.solver.skip_separating = settings.skip_separating;
    step.solver.frictionless_rows = settings.frictionless_rows;
    step.solver.freeze_contacts = settings.freeze_contacts;
    step.solver.small_regions_in_lanes = settings.small_regions_in_lanes;
    return step;
}

}  // namespace skerry
