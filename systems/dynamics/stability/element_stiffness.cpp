// The eigenvalues of M^-1/2 K M^-1/2 that are not zero are those of the 9x9 matrix  A(Y) = V H(Y L^T) L  with L L^T = Q
// and Y a 3x3 matrix. H, or something above it, is a sum of few terms that become blocks of A in closed form, and
// lambda_max(A) <= (tr A^16)^(1/16).
#include "systems/dynamics/stability/element_stiffness.h"

#include "systems/material/with_law.h"

namespace skerry {

namespace {

/// A symmetric 9x9 matrix; row 3 p + i is component i of column p of Y.
struct Matrix9 {
    Real8 a[9][9];
};

/// The lower triangular L with L L^T = Q. A pivot lost to rounding is raised to a small positive one, which only
/// enlarges Q.
LaneMat3<Real8> cholesky(const LaneMat3<Real8>& Q) {
    const Real8 least = 1e-14 * (Q.c0.x + Q.c1.y + Q.c2.z) + 1e-300;
    const auto pivot = [&](const Real8& x) { return square_root(x > least ? x : least); };
    LaneMat3<Real8> L{};
    L.c0.x = pivot(Q.c0.x);
    L.c0.y = Q.c0.y / L.c0.x;
    L.c0.z = Q.c0.z / L.c0.x;
    L.c1.y = pivot(Q.c1.y - L.c0.y * L.c0.y);
    L.c1.z = (Q.c1.z - L.c0.z * L.c0.y) / L.c1.y;
    L.c2.z = pivot(Q.c2.z - L.c0.z * L.c0.z - L.c1.z * L.c1.z);
    return L;
}

/// A(Y) = H(Y L^T) L, summed up term by term as a law adds them.
class StiffnessTerms {
public:
    explicit StiffnessTerms(const LaneMat3<Real8>& L) : L_(L) {}
    Matrix9& compressed() { return A_; }

    /// H += s identity: s (L^T L)_pq I.
    void add_identity(const Real8& s) {
        const LaneVec3<Real8> c[3] = {L_.c0, L_.c1, L_.c2};
        for (int p = 0; p < 3; ++p) {
            for (int q = 0; q < 3; ++q) {
                const Real8 x = s * dot(c[p], c[q]);
                for (int i = 0; i < 3; ++i) A_.a[3 * p + i][3 * q + i] += x;
            }
        }
    }

    /// H += s X X^T, X a matrix as a vector of nine: the dyad of X L.
    template <class Matrix>
    void add_dyad(const Real8& s, const Matrix& X) {
        const LaneMat3<Real8> XL = multiply(X, L_);
        const Real8 x[9] = {XL.c0.x, XL.c0.y, XL.c0.z, XL.c1.x, XL.c1.y, XL.c1.z, XL.c2.x, XL.c2.y, XL.c2.z};
        for (int r = 0; r < 9; ++r)
            for (int c = 0; c < 9; ++c) A_.a[r][c] += s * x[r] * x[c];
    }

    /// H += s (X -> R X^T R): the block (p, q) is the dyad of columns q and p of R L.
    template <class Matrix>
    void add_turned_transpose(const Real8& s, const Matrix& R) {
        const LaneMat3<Real8> RL = multiply(R, L_);
        const Real8 x[3][3] = {{RL.c0.x, RL.c0.y, RL.c0.z}, {RL.c1.x, RL.c1.y, RL.c1.z}, {RL.c2.x, RL.c2.y, RL.c2.z}};
        for (int p = 0; p < 3; ++p)
            for (int q = 0; q < 3; ++q)
                for (int i = 0; i < 3; ++i)
                    for (int k = 0; k < 3; ++k) A_.a[3 * p + i][3 * q + k] += s * x[q][i] * x[p][k];
    }

    /// H += s d(cof F)/dF: the block (p, q) is -[F cof(L)_m]x for (p, q, m) cyclic and plus that for (q, p, m).
    void add_cofactor_slope(const Real8& s, const LaneMat3<Real8>& F) {
        const LaneMat3<Real8> E = multiply(F, cofactor(L_));
        const LaneVec3<Real8> e[3] = {E.c0, E.c1, E.c2};
        for (int m = 0; m < 3; ++m) {
            const int p = 3 * ((m + 1) % 3), q = 3 * ((m + 2) % 3);
            const auto add = [&](int i, int k, const Real8& x) {
                A_.a[p + i][q + k] += x;
                A_.a[q + k][p + i] += x;
                A_.a[p + k][q + i] -= x;
                A_.a[q + i][p + k] -= x;
            };
            add(0, 1, s * e[m].z);
            add(1, 2, s * e[m].x);
            add(2, 0, s * e[m].y);
        }
    }

private:
    const LaneMat3<Real8>& L_;
    Matrix9 A_{};
};

/// H of the viscous parts, whose stress is F S: X -> F (2 mu sym(F^T X) + (lambda + bulk) tr(F^T X) I) + X S. F F^T and
/// S are replaced by bounds of their eigenvalues, the first by the mean of F^T F and twice its spread.
void add_viscous_stiffness(const ViscousPart& viscous, const LaneMat3<Real8>& F, StiffnessTerms& H) {
    const ViscousModuli& moduli = viscous.moduli;
    const LaneSymmetric<Real8> strain = green_strain(F), S = stress(moduli, viscous.stretch);
    const Real8 third = strain.trace() / 3.0;
    const LaneSymmetric<Real8> deviator{strain.xx - third, strain.yy - third, strain.zz - third,
                                        strain.xy,         strain.yz,         strain.zx};
    const Real8 largest = 1.0 + 2.0 * (third + 2.0 * square_root(inner_product(deviator, deviator) / 6.0));
    const Real8 mu = moduli.mu * viscous.strain_share;
    H.add_identity(mu * largest + square_root(inner_product(S, S)));
    H.add_turned_transpose(mu, F);
    H.add_dyad(moduli.lambda * viscous.strain_share + moduli.bulk * viscous.volume_share, F);
}

/// (tr A^16)^(1/16), after scaling by the norm so that nothing overflows.
Real8 largest_eigenvalue_bound(Matrix9& A) {
    const auto norm = [](const Matrix9& m) {
        Real8 sum{};
        for (const auto& row : m.a)
            for (const Real8& x : row) sum += x * x;
        return square_root(sum);
    };
    const Real8 scale = norm(A);
    const Real8 inverse = 1.0 / (scale > 0.0 ? scale : Real8{} + 1.0);
    for (auto& row : A.a)
        for (Real8& x : row) x *= inverse;
    Matrix9 other;
    Matrix9 *from = &A, *to = &other;
    for (int squaring = 0; squaring < 3; ++squaring) {
        for (int r = 0; r < 9; ++r)
            for (int c = 0; c <= r; ++c) {
                Real8 sum{};
                for (int k = 0; k < 9; ++k) sum += from->a[r][k] * from->a[c][k];
                to->a[r][c] = to->a[c][r] = sum;
            }
        std::swap(from, to);
    }
    return scale * square_root(square_root(square_root(norm(*from))));  // norm(A^8) = (tr A^16)^(1/2)
}

}  // namespace

Real8 frequency_squared_bound(const MaterialConstants& material, const LaneMat3<Real8>& F, const ViscousPart& viscous,
                              const Real8& volume, const LaneMat3<Real8>& Q, LaneQuaternion<Real8>& q) {
    const LaneMat3<Real8> L = cholesky(Q);
    StiffnessTerms H(L);
    with_law(material.model, [&](auto law) {
        if constexpr (law.has_frame) {
            extract_rotation(F, volume, q);
            law.add_stiffness(material, F, rotation_of(q), H);
        } else {
            law.add_stiffness(material, F, H);
        }
    });
    if (viscous.moduli.mu > 0 || viscous.moduli.lambda > 0 || viscous.moduli.bulk > 0)
        add_viscous_stiffness(viscous, F, H);
    const Real8 bound = volume * largest_eigenvalue_bound(H.compressed());
    return volume > 0.0 ? bound : Real8{};
}

}  // namespace skerry
