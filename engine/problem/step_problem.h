// Exports the contact problem of a step in the general form that other solvers read.
#pragma once

#include <span>

#include "engine/problem/eliminate_equations.h"
#include "skerry/problem.h"
#include "systems/solver/inputs/region_inputs.h"
#include "systems/solver/inputs/solver_settings.h"

namespace skerry {

/// Contacts of a step before the solve, and the impulses that the solve has found. `contacts.velocity` and
/// `free_velocity` are the values before the solve.
struct StepContacts {
    RegionInputs contacts;
    std::span<const Vec3> free_velocity;  // predicted velocity of each node without contacts [m/s]
    std::span<const Vec3> impulse;        // impulse of each contact after the solve, in the world frame [N s]
    std::span<const Index> region;        // region number of each contact
    const StepEquations& equations;
};

/// Exports the contact problem that solve_regions solves, in contact frames. Fills problem (without its name and the
/// start of its description), impulse, contact and region of the result.
/// - W is computed from stencils and inverse masses.
/// - q is the predicted relative velocity plus the bias: a velocity offset with which a gap may close within the step,
///   and an impact rebounds.
/// - mu is the dynamic coefficient if static and dynamic friction differ.
///
/// Equations of joints, ties, rollers and cables are not part of the result: see eliminate_equations.
StepProblem step_problem(const StepContacts& step, const SolverSettings& settings, Real h);

}  // namespace skerry
