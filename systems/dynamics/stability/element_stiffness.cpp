// Bounds the largest eigenvalue of M^-1/2 K M^-1/2 for an element with mass matrix M and stiffness K
// (docs/methods/stable_step.md 3).
//
// The nonzero eigenvalues are those of V A, with the volume V and a 9x9 matrix A. A maps a 3x3 matrix Y to H(Y L^T) L,
// where H = dP/dF is the tangent of the material law, and L L^T = Q the tensor of inverse masses. Each term of H, or of
// an upper bound on it, adds a closed-form term to A.
//
// The bound is lambda_max(A) <= (tr A^16)^(1/16). A cheaper test shows whether V lambda_max(A) is below a limit c: then
// c I - V A is positive definite.
#include "systems/dynamics/stability/element_stiffness.h"

#include <array>

#include "systems/material/with_law.h"

namespace skerry {

namespace {

/// Symmetric 9x9 matrix, stored without the entries above the diagonal. It acts on 3x3 matrices Y: row 3 p + i belongs
/// to component i of column p of Y.
template <class T>
struct Matrix9 {
    T a[9][9];
};

/// Those of the eight lanes that belong to register number `part`: `kernel_parts` registers hold the eight lanes. A 9x9
/// matrix is built for one register at a time.
[[gnu::always_inline]] inline KernelReal lanes_in(const Real8& x, std::size_t part) {
    Lanes<Real, element_lanes> all;
    store(x, all);
    return load_part<KernelReal>(all, part);
}
LaneMat3<KernelReal> lanes_in(const LaneMat3<Real8>& m, std::size_t part) {
    const auto column = [part](const LaneVec3<Real8>& c) {
        return LaneVec3<KernelReal>{lanes_in(c.x, part), lanes_in(c.y, part), lanes_in(c.z, part)};
    };
    return {column(m.c0), column(m.c1), column(m.c2)};
}
LaneSymmetric<KernelReal> lanes_in(const LaneSymmetric<Real8>& s, std::size_t part) {
    return {lanes_in(s.xx, part), lanes_in(s.yy, part), lanes_in(s.zz, part),
            lanes_in(s.xy, part), lanes_in(s.yz, part), lanes_in(s.zx, part)};
}

/// Cholesky factor of Q: lower triangular L with L L^T = Q. If rounding makes a pivot too small, it is raised to a
/// small positive number. This only enlarges Q, so the bound on the frequency stays an upper bound.
template <class T>
LaneMat3<T> cholesky(const LaneMat3<T>& Q) {
    const T least = 1e-14 * (Q.c0.x + Q.c1.y + Q.c2.z) + 1e-300;
    const auto pivot = [&](const T& x) { return square_root(x > least ? x : least); };
    LaneMat3<T> L{};
    L.c0.x = pivot(Q.c0.x);
    L.c0.y = Q.c0.y / L.c0.x;
    L.c0.z = Q.c0.z / L.c0.x;
    L.c1.y = pivot(Q.c1.y - L.c0.y * L.c0.y);
    L.c1.z = (Q.c1.z - L.c0.z * L.c0.y) / L.c1.y;
    L.c2.z = pivot(Q.c2.z - L.c0.z * L.c0.z - L.c1.z * L.c1.z);
    return L;
}

/// Builds the 9x9 matrix A(Y) = H(Y L^T) L from the terms that a material law adds to H = dP/dF. Y is a 3x3 matrix, and
/// L L^T is the tensor of inverse masses.
template <class T>
class StiffnessTerms {
public:
    StiffnessTerms(const LaneMat3<T>& L, Matrix9<T>& A) : L_(L), A_(A) { A_ = {}; }

    /// Adds s times the identity to H. Block (p, q) of the 9x9 matrix A grows by s (L^T L)_pq I.
    void add_identity(const T& s) {
        const LaneVec3<T> c[3] = {L_.c0, L_.c1, L_.c2};
        for (int p = 0; p < 3; ++p) {
            for (int q = 0; q <= p; ++q) {
                const T x = s * dot(c[p], c[q]);
                for (int i = 0; i < 3; ++i) A_.a[3 * p + i][3 * q + i] += x;
            }
        }
    }

    /// Adds s times the dyad X X^T to H, with the matrix X as a vector of nine entries. The 9x9 matrix A grows by s
    /// times the dyad of X L.
    template <class Matrix>
    void add_dyad(const T& s, const Matrix& X) {
        const LaneMat3<T> XL = multiply(X, L_);
        const T x[9] = {XL.c0.x, XL.c0.y, XL.c0.z, XL.c1.x, XL.c1.y, XL.c1.z, XL.c2.x, XL.c2.y, XL.c2.z};
        for (int r = 0; r < 9; ++r)
            for (int c = 0; c <= r; ++c) A_.a[r][c] += s * x[r] * x[c];
    }

    /// Adds the map X -> s R X^T R to the tangent H of the material law. The 3x3 block (p, q) of the 9x9 matrix A grows
    /// by s times the dyad of columns q and p of R L, with the Cholesky factor L of this object.
    template <class Matrix>
    void add_turned_transpose(const T& s, const Matrix& R) {
        const LaneMat3<T> RL = multiply(R, L_);
        const T x[3][3] = {{RL.c0.x, RL.c0.y, RL.c0.z}, {RL.c1.x, RL.c1.y, RL.c1.z}, {RL.c2.x, RL.c2.y, RL.c2.z}};
        for (int p = 0; p < 3; ++p)
            for (int q = 0; q <= p; ++q)
                for (int i = 0; i < 3; ++i)
                    for (int k = 0; k < (p == q ? i + 1 : 3); ++k) A_.a[3 * p + i][3 * q + k] += s * x[q][i] * x[p][k];
    }

    /// Adds s times the derivative d(cof F)/dF of the cofactor matrix to the tangent H of the material law. Let e_m be
    /// column m of F cof(L), with the Cholesky factor L of this object. [e]x is the matrix of the cross product with e.
    /// The 3x3 block (p, q) of the 9x9 matrix A grows by
    ///     -s [e_m]x    if (p, q, m) is a cyclic permutation of (0, 1, 2)
    ///      s [e_m]x    if (q, p, m) is one
    void add_cofactor_slope(const T& s, const LaneMat3<T>& F) {
        const LaneMat3<T> E = multiply(F, cofactor(L_));
        const LaneVec3<T> e[3] = {E.c0, E.c1, E.c2};
        for (int m = 0; m < 3; ++m) {
            const int p = 3 * ((m + 1) % 3), q = 3 * ((m + 2) % 3);
            const auto add = [&](int i, int k, const T& x) {
                T& one = p > q ? A_.a[p + i][q + k] : A_.a[q + k][p + i];
                T& other = p > q ? A_.a[p + k][q + i] : A_.a[q + i][p + k];
                one += x;
                other -= x;
            };
            add(0, 1, s * e[m].z);
            add(1, 2, s * e[m].x);
            add(2, 0, s * e[m].y);
        }
    }

private:
    const LaneMat3<T>& L_;
    Matrix9<T>& A_;
};

/// Adds an upper bound on H = dP/dF of the viscous stress P = F S to H (docs/methods/stable_step.md 4.4). S is the
/// second Piola-Kirchhoff stress of the springs. The bound replaces F F^T and S by upper bounds on their eigenvalues.
template <class T>
void add_viscous_stiffness(const ViscousPart& viscous, std::size_t part, const LaneMat3<T>& F, StiffnessTerms<T>& H) {
    const ViscousModuli& moduli = viscous.moduli;
    const ViscousStretch<T> stretch{lanes_in(viscous.stretch.strain, part), lanes_in(viscous.stretch.volume, part)};
    const LaneSymmetric<T> strain = twice_green_strain(F), S = stress(moduli, stretch);
    const T third = strain.trace() / 3.0;
    const LaneSymmetric<T> deviator{strain.xx - third, strain.yy - third, strain.zz - third,
                                    strain.xy,         strain.yz,         strain.zx};
    // Bound for F F^T: mean eigenvalue of F^T F plus 2 sqrt(|D|^2 / 6), where D is the deviator of F^T F.
    const T largest = 1.0 + (third + 2.0 * square_root(inner_product(deviator, deviator) / 6.0));
    const T strain_share = lanes_in(viscous.strain_share, part), volume_share = lanes_in(viscous.volume_share, part);
    const T mu = moduli.mu * strain_share;
    H.add_identity(mu * largest + square_root(inner_product(S, S)));
    H.add_turned_transpose(mu, F);
    H.add_dyad(moduli.lambda * strain_share + moduli.bulk * volume_share, F);
}

/// Changes A to D A D, because the mass form of the element has the additional term b (R:X)^2. R is a rotation,
/// X = Y L^T the displacement gradient, and s = R L as a vector of nine entries. So R:X = s.Y, and with a scalar c
///     mass form = |Y|^2 + b (s.Y)^2 = Y.(1 + b s s^T) Y
///     D         = (1 + b s s^T)^-1/2 = 1 - c s s^T
template <class T>
void add_frame_mass(const LaneMat3<T>& R, const T& b, const LaneMat3<T>& L, Matrix9<T>& A) {
    const LaneMat3<T> RL = multiply(R, L);
    const T s[9] = {RL.c0.x, RL.c0.y, RL.c0.z, RL.c1.x, RL.c1.y, RL.c1.z, RL.c2.x, RL.c2.y, RL.c2.z};
    const T size = inner_product(RL, RL);
    const T c = (1.0 - 1.0 / square_root(1.0 + b * size)) / (size > 0.0 ? size : T{} + 1.0);
    T u[9];  // A s
    T sAs{};
    for (int r = 0; r < 9; ++r) {
        u[r] = T{};
        for (int k = 0; k < 9; ++k) u[r] += (k <= r ? A.a[r][k] : A.a[k][r]) * s[k];
        sAs += s[r] * u[r];
    }
    const T twice = c * c * sAs;
    for (int r = 0; r < 9; ++r)
        for (int k = 0; k <= r; ++k) A.a[r][k] += twice * s[r] * s[k] - c * (s[r] * u[k] + u[r] * s[k]);
}

/// For each lane of this register: true if all eigenvalues of volume * A are below `limit`. This holds if limit I -
/// volume * A has a Cholesky decomposition L D L^T with the diagonal of D above rounding errors. The test ends early if
/// no lane passes.
template <class T>
auto is_below(const Matrix9<T>& A, const T& volume, const T& limit) {
    const T rounding = 1e-12 * limit;
    auto below = limit > 0.0;
    T m[9][9];     // entries of L D below the diagonal
    T inverse[9];  // inverse of each diagonal entry of D
    for (int c = 0; c < 9; ++c) {
        T scaled[9];  // row c of L
        T pivot = limit - volume * A.a[c][c];
        for (int k = 0; k < c; ++k) {
            scaled[k] = m[c][k] * inverse[k];
            pivot -= m[c][k] * scaled[k];
        }
        below &= pivot > rounding;
        if (all(below == 0)) break;
        inverse[c] = 1.0 / (pivot > rounding ? pivot : T{} + 1.0);
        for (int r = c + 1; r < 9; ++r) {
            T sum = -(volume * A.a[r][c]);
            for (int k = 0; k < c; ++k) sum -= m[r][k] * scaled[k];
            m[r][c] = sum;
        }
    }
    return below;
}

/// Upper bound (tr A^16)^(1/16) on the largest eigenvalue of A. Scaling by the norm of A prevents overflow. A is
/// overwritten.
template <class T>
T largest_eigenvalue_bound(Matrix9<T>& A) {
    for (int r = 0; r < 9; ++r)
        for (int c = 0; c < r; ++c) A.a[c][r] = A.a[r][c];
    const auto norm = [](const Matrix9<T>& m) {
        T sum{};
        for (const auto& row : m.a)
            for (const T& x : row) sum += x * x;
        return square_root(sum);
    };
    const T scale = norm(A);
    const T inverse = 1.0 / (scale > 0.0 ? scale : T{} + 1.0);
    for (auto& row : A.a)
        for (T& x : row) x *= inverse;
    Matrix9<T> other;
    Matrix9<T>*from = &A, *to = &other;
    for (int squaring = 0; squaring < 3; ++squaring) {
        for (int r = 0; r < 9; ++r)
            for (int c = 0; c <= r; ++c) {
                T sum{};
                for (int k = 0; k < 9; ++k) sum += from->a[r][k] * from->a[c][k];
                to->a[r][c] = to->a[c][r] = sum;
            }
        std::swap(from, to);
    }
    return scale * square_root(square_root(square_root(norm(*from))));  // norm(A^8) = (tr A^16)^(1/2)
}

LaneMat3<KernelReal> everywhere(const Mat3& m) {
    const auto column = [&](Eigen::Index c) {
        return LaneVec3<KernelReal>{KernelReal{} + m(0, c), KernelReal{} + m(1, c), KernelReal{} + m(2, c)};
    };
    return {column(0), column(1), column(2)};
}

using BlockMatrices = std::array<Matrix9<KernelReal>, kernel_parts>;
using BlockReals = std::array<KernelReal, kernel_parts>;

/// Upper bounds on the largest eigenvalue of volume * A in each lane, by bisection between `low` and `high` with
/// geometric means. `high` must be an upper bound of the eigenvalue. If the eigenvalue is below `low`, the result is
/// slightly above `low`. Lanes are bisected separately, so that results have the same bits for every register width.
BlockReals bisected(const BlockMatrices& A, const BlockReals& volume, BlockReals low, BlockReals high, int halvings) {
    for (std::size_t part = 0; part < kernel_parts; ++part)
        for (int i = 0; i < halvings; ++i) {
            const KernelReal middle = square_root(low[part] * high[part]);
            const auto below = is_below(A[part], volume[part], middle);
            high[part] = below ? middle : high[part];
            low[part] = below ? low[part] : middle;
        }
    return high;
}

/// Upper bounds on the largest eigenvalue of volume * A in each lane of a block, if this eigenvalue exceeds `threshold`
/// in some lanes. Limits just above `threshold` are tried first, because the excess is probably small. The greatest of
/// the bounds is at most 0.3 % too large.
BlockReals bisected_bound(const BlockMatrices& A, const BlockReals& volume, Real threshold) {
    const auto all_below = [&](Real limit) {
        for (std::size_t part = 0; part < kernel_parts; ++part)
            if (!all(is_below(A[part], volume[part], KernelReal{} + limit))) return false;
        return true;
    };
    const auto everywhere = [](Real x) {
        BlockReals reals;
        reals.fill(KernelReal{} + x);
        return reals;
    };
    Real low = threshold, step = 1.01;
    for (int halvings = 2; threshold > 0 && halvings < 6; ++halvings, low *= step, step *= step)
        if (all_below(low * step)) return bisected(A, volume, everywhere(low), everywhere(low * step), halvings);
    BlockReals least, most;
    for (std::size_t part = 0; part < kernel_parts; ++part) {
        Matrix9<KernelReal> powers = A[part];
        most[part] = volume[part] * largest_eigenvalue_bound(powers);
        least[part] = most[part] / 1.1472026904398771;  // 9^(1/16), since tr A^16 <= 9 lambda_max^16
    }
    return bisected(A, volume, least, most, 6);
}

/// Upper bound on the largest eigenvalue of volume * A in each lane: the smallest of the limits threshold, 1.1
/// threshold, 1.21 threshold ... that exceeds the eigenvalue. The bound is infinite if all limits are below the
/// eigenvalue.
BlockReals stepped_bound(const BlockMatrices& A, const BlockReals& volume, Real threshold) {
    constexpr Real growth = 1.1;
    constexpr int steps = 25;
    BlockReals bounds;
    for (std::size_t part = 0; part < kernel_parts; ++part) {
        const KernelReal unknown = KernelReal{} + infinity;
        KernelReal& bound = bounds[part] = unknown;
        Real limit = threshold;
        for (int i = 0; i < steps && !all(bound < unknown); ++i, limit *= growth) {
            const auto below = is_below(A[part], volume[part], KernelReal{} + limit);
            bound = below & (bound == unknown) ? KernelReal{} + limit : bound;
        }
    }
    return bounds;
}

}  // namespace

Real8 frequency_squared_bound(const MaterialConstants& material, const LaneMat3<Real8>& F, const ViscousPart& viscous,
                              const Real8& volume, const LaneMat3<Real8>& Q, LaneQuaternion<Real8>& q, Real threshold,
                              Sharpness sharpness, const FramePart* frame) {
    const bool relaxes = viscous.moduli.mu > 0 || viscous.moduli.lambda > 0 || viscous.moduli.bulk > 0;
    BlockMatrices A;
    with_law(material.model, [&](auto law) {
        if constexpr (law.has_frame) extract_rotation(F, volume, q);
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const LaneMat3<KernelReal> F_part = lanes_in(F, part), L = cholesky(lanes_in(Q, part));
            StiffnessTerms<KernelReal> H(L, A[part]);
            if constexpr (law.has_frame)
                law.add_stiffness(material, F_part, lanes_in(rotation_of(q), part), H);
            else
                law.add_stiffness(material, F_part, H);
            if (relaxes) add_viscous_stiffness(viscous, part, F_part, H);
            if (frame) add_frame_mass(everywhere(frame->rotation), lanes_in(frame->b, part), L, A[part]);
        }
    });
    // All lanes of the block are tested together, so that the results have the same bits for every register width.
    bool below = threshold > 0;
    for (std::size_t part = 0; below && part < kernel_parts; ++part)
        below = all(is_below(A[part], lanes_in(volume, part), KernelReal{} + threshold));
    if (below) return Real8{} + threshold;
    if (sharpness == Sharpness::compared) return Real8{} + infinity;
    BlockReals volumes, bounds;
    for (std::size_t part = 0; part < kernel_parts; ++part) volumes[part] = lanes_in(volume, part);
    if (sharpness == Sharpness::bisected)
        bounds = bisected_bound(A, volumes, threshold);
    else if (sharpness == Sharpness::stepped)
        bounds = stepped_bound(A, volumes, threshold);
    else
        for (std::size_t part = 0; part < kernel_parts; ++part)
            bounds[part] = volumes[part] * largest_eigenvalue_bound(A[part]);
    Lanes<Real, element_lanes> bound;
    for (std::size_t part = 0; part < kernel_parts; ++part) store_part(bounds[part], bound, part);
    return volume > 0.0 ? load(bound) : Real8{};
}

}  // namespace skerry
