// Tangent of a material law for Newton steps: dP/dF with negative eigenvalues replaced by 0, so that each step goes
// downhill in energy.
#pragma once

#include <array>

#include "components/types.h"

namespace skerry {

/// Derivative dP/dF of the stress P in the principal axes of F = left diag(s) right^T, with negative eigenvalues
/// replaced by 0 (Stomakhin, Howes, Schroeder, Teran 2012; Smith, de Goes, Kim 2018) [Pa].
///
/// A change X of F has the components X' = left^T X right in these axes. The stress changes by left Y' right^T, with
/// - diagonal: vector of the three Y'_ii = `normal` times the vector of the three X'_ii
/// - symmetric part, i != j: Y'_ij + Y'_ji = flip_k (X'_ij + X'_ji)
/// - antisymmetric part, i != j: Y'_ij - Y'_ji = twist_k (X'_ij - X'_ji)
///
/// Here k is the third axis, neither i nor j. So flip_k and twist_k are stiffnesses for changes in the plane of the
/// axes i and j.
struct Tangent {
    Mat3 left, right;
    Mat3 normal;
    Vec3 flip, twist;
    // Further parts of dP/dF that only anisotropic laws have. They map a change X of F to sum_k (D_k : X) D_k + X S,
    // with the matrices D_k of `dyads` and the symmetric matrix S = `second_stress` [Pa^(1/2) and Pa].
    std::array<Mat3, 7> dyads{};
    Mat3 second_stress{};
    bool is_anisotropic = false;
};

/// Signed singular value decomposition F = left diag(stretch) right^T with rotations `left` and `right`. The smallest
/// stretch is negative if F contains a reflection.
struct Stretches {
    Mat3 left, right;
    Vec3 stretch;

    explicit Stretches(const Mat3& F);
};

/// Returns the tangent with the entries `normal`, `flip` and `twist`, after setting negative eigenvalues to zero [Pa].
Tangent without_softening(const Stretches& frames, const Mat3& normal, const Vec3& flip, const Vec3& twist);

}  // namespace skerry
