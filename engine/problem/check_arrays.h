#pragma once

#include <string>

#include "skerry/problem.h"

namespace skerry {

/// Returns the name of the problem for error messages.
std::string title_of(const ContactProblem& problem);

/// Throws SceneError if the arrays of the problem have inconsistent sizes or indices, or values out of range, or
/// if W is not symmetric.
void check_arrays(const ContactProblem& problem);

}  // namespace skerry
