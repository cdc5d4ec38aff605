// Exact Coulomb solution of one contact with a general symmetric positive semidefinite 3x3 block
// (docs/methods/friction.md 3). Vectors are in the contact frame: normal, tangent 1, tangent 2.
#pragma once

#include "components/types.h"

namespace skerry {

/// A 3x3 block prepared for many right-hand sides. The normal row is eliminated from the tangential rows, and the
/// tangents are rotated to the principal axes of the remainder.
struct LocalBlock {
    Real normal;          // normal entry of the block [1/kg]
    Real inverse_normal;  // inverse of `normal`; 0 if there is no mobility along the normal [kg]
    Real coupling[2];     // coupling between normal and tangents, along the principal axes [1/kg]
    Real eigenvalue[2];   // eigenvalues > 0 of the tangential Schur complement [1/kg]
    Real cosine, sine;    // rotation of the tangents to the principal axes
    // Ratio |u_t| / |r_t| of the last sliding solution. The next search for this ratio starts from it, so it affects
    // only the speed of the search [1/kg].
    Real slip;
};

/// Prepares the symmetric part of a 3x3 block.
LocalBlock prepare_block(const Mat3& matrix);

/// Returns the impulse r that satisfies Coulomb's law with the velocity u = W r + b. The impulse is zero if the block
/// has no mobility along the normal.
Vec3 solve_block(LocalBlock& block, const Vec3& b, Real mu);

}  // namespace skerry
