// Measures the error of reactions as a solution of a problem (docs/methods/errors.md 3).
#pragma once

#include <span>

#include "skerry/problem.h"

namespace skerry {

/// With Friction::pyramid the measures are those of the pyramid: each tangential component has its own bound.
ProblemError measure_problem(const ContactProblem& problem, std::span<const Vec3> reaction, Friction friction);

}  // namespace skerry
