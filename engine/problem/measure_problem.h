// Measures how well given impulses solve a contact problem (docs/methods/errors.md 3).
#pragma once

#include <span>

#include "skerry/problem.h"

namespace skerry {

/// Returns the errors of `reaction`. With Friction::pyramid the errors refer to the friction pyramid, where mu r_n
/// bounds each tangential component separately.
ProblemError measure_problem(const ContactProblem& problem, std::span<const Vec3> reaction, Friction friction);

}  // namespace skerry
