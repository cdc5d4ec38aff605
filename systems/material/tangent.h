// Tangent of a law for Newton steps: dP/dF without its negative eigenvalues.
#pragma once

#include "components/types.h"

namespace skerry {

/// dP/dF of a law in the frames of F = left diag(s) right^T [Pa]. With X' = left^T X right: normal X'_ii on the
/// diagonal, (flip + twist)/2 X'_ij + (flip - twist)/2 X'_ji off it (Stomakhin, Howes, Schroeder, Teran 2012; Smith, de
/// Goes, Kim 2018). Entry k of `flip` and `twist` belongs to the pair i, j that leaves out axis k. No eigenvalue is
/// negative.
struct Tangent {
    Mat3 left, right;
    Mat3 normal;
    Vec3 flip, twist;
};

/// F = left diag(stretch) right^T with rotations `left` and `right`: the smallest stretch is negative if F is mirrored.
struct Stretches {
    Mat3 left, right;
    Vec3 stretch;

    explicit Stretches(const Mat3& F);
};

/// A Tangent of `normal`, `flip` and `twist` with negative eigenvalues set to zero [Pa].
Tangent without_softening(const Stretches& frames, const Mat3& normal, const Vec3& flip, const Vec3& twist);

}  // namespace skerry
