// The contact problem that a step hands to its solver, in the form that other solvers read.
#pragma once

#include <span>

#include "skerry/problem.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"

namespace skerry {

/// What the contacts of a step saw and became. `contacts.velocity` and `free_velocity` are those before the solve.
struct StepContacts {
    RegionInputs contacts;
    std::span<const Vec3> free_velocity;  // m/s, by node: predicted
    std::span<const Vec3> impulse;        // N s, world frame, by contact: after the solve
    std::span<const Index> region;        // by contact
};

/// W from stencils and inverse masses, q from the predicted velocity and the bias of the gap, both in contact frames:
/// what solve_regions solves, but for friction coefficients that differ (mu is the dynamic one). Fills problem (but for
/// its name and the start of its description), impulse, contact and region of the result.
StepProblem step_problem(const StepContacts& step, const SolverSettings& settings, Real h);

}  // namespace skerry
