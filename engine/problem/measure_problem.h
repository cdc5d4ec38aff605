// Measures how well given impulses solve a contact problem (docs/methods/errors.md 3).
#pragma once

#include <span>

#include "skerry/problem.h"

namespace skerry {

/// Returns the errors of `reaction`. With Friction::pyramid the errors refer to the friction pyramid, where each
/// tangential component has the bound mu r_n of its own.
ProblemError measure_problem(const ContactProblem& problem, std::span<const Vec3> reaction, Friction friction);

}  // namespace skerry
