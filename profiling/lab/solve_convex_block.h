// Solution of one contact with a general symmetric positive block under the associated law. The impulse r in the cone K
// minimises r . W r / 2 + b . r, so that u = W r + b lies in the dual cone and u . r = 0. Frame: normal, tangent 1,
// tangent 2.
#pragma once

#include "components/types.h"

namespace skerry::lab {

/// A block prepared for many right-hand sides. K is half of {S <= 0}, S = r_t^2 - mu^2 r_n^2; the axes diagonalise W
/// and S together.
struct ConvexBlock {
    Mat3 axes;            // T' W T = 1, T' S T = diag(-1, ratio) times a number; the first axis lies in K
    Real ratio[2];        // > 0
    Real inverse_normal;  // inverse of the first entry of the block, 0: no mobility along the normal [kg]
};

/// Prepares the symmetric part of the block. Its diagonal is raised by 1e-14 of its trace so that a block of lower rank
/// can be factorised.
ConvexBlock prepare_convex_block(const Mat3& matrix, Real mu);

/// Returns r. The result is zero for a block without mobility along the normal.
Vec3 solve_convex_block(const ConvexBlock& block, const Vec3& b, Real mu);

}  // namespace skerry::lab
