#pragma once

#include "skerry/problem.h"

namespace skerry {

/// Throws SceneError when the arrays of the problem disagree.
void check_arrays(const ContactProblem& problem);

}  // namespace skerry
