// Converts the global form of a contact problem to the local one: W = H^T M^-1 H, q = H^T M^-1 f + w.
#pragma once

#include <string>
#include <vector>

#include "engine/problem/fclib_matrix.h"
#include "skerry/problem.h"

namespace skerry {

/// Global form: M v = H r + f, u = H^T v + w.
struct GlobalProblem {
    MatrixEntries mass;        // M, symmetric positive definite
    MatrixEntries directions;  // H, three columns per contact
    std::vector<Real> force;   // f
};

/// Reason why M cannot be used; empty if it can.
struct MassFault {
    std::string found, expected;
};

/// Fills blocks, q and freedoms of `problem`; on input its q holds w. M is divided into parts that no entry connects
/// (the bodies). Each part is factorised separately, so only contacts on the same part are coupled. Blocks that are
/// zero up to rounding are omitted.
MassFault condense_problem(const GlobalProblem& global, ContactProblem& problem);

}  // namespace skerry
