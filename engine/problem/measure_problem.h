// How far reactions are from solving a problem (docs/methods/errors.md 3).
#pragma once

#include <span>

#include "skerry/problem.h"

namespace skerry {

/// With Friction::pyramid the measures are those of the pyramid: tangential components are bounded one by one.
ProblemError measure_problem(const ContactProblem& problem, std::span<const Vec3> reaction, Friction friction);

}  // namespace skerry
