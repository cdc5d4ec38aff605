// The exact Coulomb solution of one contact with a general symmetric positive block (docs/methods/friction.md 3), in
// its own frame: normal, tangent 1, tangent 2.
#pragma once

#include "components/types.h"

namespace skerry {

/// A block prepared for many right-hand sides: the tangents after the normal is eliminated, turned to their principal
/// axes.
struct LocalBlock {
    Real normal;          // s/kg, the block's first entry
    Real inverse_normal;  // kg/s; 0: no mobility along the normal
    Real coupling[2];     // s/kg, tangent to normal, along the principal axes
    Real eigenvalue[2];   // s/kg, of the tangential Schur complement, > 0
    Real cosine, sine;    // of the principal axes
    // s/kg, |u_t| / |r_t| of the last solution that slid: where the next search starts. Only speed depends on it
    Real slip;
};

/// Of the symmetric part of the block.
LocalBlock prepare_block(const Mat3& matrix);

/// r with u = W r + b and the Coulomb law. A block without mobility along the normal gives zero.
Vec3 solve_block(LocalBlock& block, const Vec3& b, Real mu);

}  // namespace skerry
