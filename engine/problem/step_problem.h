// Exports the contact problem of a step in the form that other solvers read.
#pragma once

#include <span>

#include "skerry/problem.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"

namespace skerry {

/// Input and result of a step's contacts. `contacts.velocity` and `free_velocity` are those before the solve.
struct StepContacts {
    RegionInputs contacts;
    std::span<const Vec3> free_velocity;  // predicted velocity by node [m/s]
    std::span<const Vec3> impulse;        // after the solve, world frame, by contact [N s]
    std::span<const Index> region;        // by contact
};

/// Computes W from stencils and inverse masses, and q from the predicted velocity and the bias of the gap, both in
/// contact frames. This is the problem of solve_regions, except where friction coefficients differ (mu is the dynamic
/// one). Fills problem (without its name and the start of its description), impulse, contact and region of the result.
StepProblem step_problem(const StepContacts& step, const SolverSettings& settings, Real h);

}  // namespace skerry
