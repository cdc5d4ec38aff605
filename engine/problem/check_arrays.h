#pragma once

#include "skerry/problem.h"

namespace skerry {

/// Throws SceneError if the arrays of the problem have inconsistent sizes or indices, or values out of range, or
/// if W is not symmetric.
void check_arrays(const ContactProblem& problem);

}  // namespace skerry
