// What an element's stress changes by, for Newton steps: dP/dF without its negative eigenvalues.
#pragma once

#include "components/types.h"

namespace skerry {

/// dP/dF of a law in the frames of F = left diag(s) right^T. With X' = left^T X right: on the diagonal normal X'_ii,
/// off it (flip + twist)/2 X'_ij + (flip - twist)/2 X'_ji (Stomakhin, Howes, Schroeder, Teran 2012; Smith, de Goes, Kim
/// 2018). `flip` and `twist` by the axis that the pair i, j leaves out. Not below zero anywhere.
struct Tangent {
    Mat3 left, right;
    Mat3 normal;
    Vec3 flip, twist;
};

/// F = left diag(stretch) right^T with rotations: the smallest stretch is negative where F is mirrored.
struct Stretches {
    Mat3 left, right;
    Vec3 stretch;

    explicit Stretches(const Mat3& F);
};

/// `normal`, `flip` and `twist` (Pa) with what is below zero of their eigenvalues set to zero.
Tangent without_softening(const Stretches& frames, const Mat3& normal, const Vec3& flip, const Vec3& twist);

}  // namespace skerry
