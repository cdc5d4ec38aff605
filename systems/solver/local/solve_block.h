// Exact Coulomb solution of one contact with a general symmetric positive block (docs/methods/friction.md 3), in its
// own frame: normal, tangent 1, tangent 2.
#pragma once

#include "components/types.h"

namespace skerry {

/// A block prepared for many right-hand sides: the normal is eliminated from the tangents, and these are rotated to
/// their principal axes.
struct LocalBlock {
    Real normal;          // first entry of the block [1/kg]
    Real inverse_normal;  // 0: no mobility along the normal [kg/s]
    Real coupling[2];     // coupling of tangents and normal, along the principal axes [1/kg]
    Real eigenvalue[2];   // eigenvalues > 0 of the tangential Schur complement [1/kg]
    Real cosine, sine;    // rotation to the principal axes
    // |u_t| / |r_t| of the last sliding solution, the start of the next search. It affects only speed [1/kg]
    Real slip;
};

/// Prepares the symmetric part of the block.
LocalBlock prepare_block(const Mat3& matrix);

/// Returns r with u = W r + b and Coulomb's law. A block without mobility along the normal gives zero.
Vec3 solve_block(LocalBlock& block, const Vec3& b, Real mu);

}  // namespace skerry
