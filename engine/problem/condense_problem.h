// From the global form of a contact problem to the local one: W = H^T M^-1 H, q = H^T M^-1 f + w.
#pragma once

#include <string>
#include <vector>

#include "engine/problem/fclib_matrix.h"
#include "skerry/problem.h"

namespace skerry {

/// M v = H r + f, u = H^T v + w.
struct GlobalProblem {
    MatrixEntries mass;        // M, symmetric positive definite
    MatrixEntries directions;  // H, three columns a contact
    std::vector<Real> force;   // f
};

/// Why M cannot be used. Empty: it can.
struct MassFault {
    std::string found, expected;
};

/// Fills blocks, q and freedoms of `problem`, whose q holds w. M falls into parts that no entry joins (the bodies):
/// each is factorised on its own, so that only contacts on the same part are coupled. Blocks that rounding alone keeps
/// from being zero are left out.
MassFault condense_problem(const GlobalProblem& global, ContactProblem& problem);

}  // namespace skerry
