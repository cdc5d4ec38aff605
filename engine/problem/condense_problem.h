// Converts the global form of a contact problem (M v = H r + f, u = H^T v + w) to the local form (u = W r + q), where W
// = H^T M^-1 H and q = H^T M^-1 f + w.
#pragma once

#include <string>
#include <vector>

#include "engine/problem/fclib_matrix.h"
#include "skerry/problem.h"

namespace skerry {

/// Global form of a contact problem: M v = H r + f, u = H^T v + w. The symbols are
/// - M, v: mass matrix and velocities of the bodies,
/// - H, r: contact directions and impulses,
/// - f: momenta that the bodies would have without contacts,
/// - u, w: relative velocities at the contacts, and the prescribed part of u.
struct GlobalProblem {
    MatrixEntries mass;        // mass matrix M, symmetric positive definite
    MatrixEntries directions;  // matrix H of contact directions, three columns per contact
    std::vector<Real> force;   // f, one entry per degree of freedom
};

/// Reason why the mass matrix cannot be used. Both texts are empty if it can be used.
struct MassFault {
    std::string found, expected;
};

/// Computes blocks, q and freedoms of `problem`, whose q must contain w on input.
///
/// The mass matrix M is divided into independent parts (the bodies), which no entry of M connects. Each part is
/// factorised separately, and couples only its own contacts. Blocks of W that are zero up to rounding are omitted.
MassFault condense_problem(const GlobalProblem& global, ContactProblem& problem);

}  // namespace skerry
