// The eigenvalues of M^-1/2 K M^-1/2 that are not zero are those of the 9x9 matrix  A(Y) = V H(Y L^T) L  with L L^T = Q and Y a 3x3 matrix.
// H, or something above it, is a sum of few terms that become blocks of A in closed form, and lambda_max(A) <= (tr A^16)^(1/16).
#include "systems/dynamics/element_stiffness.h"

#include "systems/material/stable_neo_hookean.h"

namespace skerry {

namespace {

/// A symmetric 9x9 matrix; row 3 p + i is component i of column p of Y.
struct Matrix9 {
    Real8 a[9][9];
};

/// The lower triangular L with L L^T = Q. A pivot lost to rounding is raised to a small positive one, which only enlarges Q.
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

/// += s H for H = identity: s (L^T L)_pq I.
void add_identity(const Real8& s, const LaneMat3<Real8>& L, Matrix9& A) {
    const LaneVec3<Real8> c[3] = {L.c0, L.c1, L.c2};
    for (int p = 0; p < 3; ++p) {
        for (int q = 0; q < 3; ++q) {
            const Real8 x = s * dot(c[p], c[q]);
            for (int i = 0; i < 3; ++i) A.a[3 * p + i][3 * q + i] += x;
        }
    }
}

/// += s H for H = X X^T (a dyad of 9-vectors), given XL = X L.
void add_dyad(const Real8& s, const LaneMat3<Real8>& XL, Matrix9& A) {
    const Real8 x[9] = {XL.c0.x, XL.c0.y, XL.c0.z, XL.c1.x, XL.c1.y, XL.c1.z, XL.c2.x, XL.c2.y, XL.c2.z};
    for (int r = 0; r < 9; ++r)
        for (int c = 0; c < 9; ++c) A.a[r][c] += s * x[r] * x[c];
}

/// += s H for H: X -> R X^T R, given RL = R L: the block (p, q) is the dyad of columns q and p.
void add_turned_transpose(const Real8& s, const LaneMat3<Real8>& RL, Matrix9& A) {
    const Real8 x[3][3] = {{RL.c0.x, RL.c0.y, RL.c0.z}, {RL.c1.x, RL.c1.y, RL.c1.z}, {RL.c2.x, RL.c2.y, RL.c2.z}};
    for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q)
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k) A.a[3 * p + i][3 * q + k] += s * x[q][i] * x[p][k];
}

/// += s H for H = d(cof F)/dF: the block (p, q) is -[F cof(L)_m]x for (p, q, m) cyclic and plus that for (q, p, m).
void add_cofactor_slope(const Real8& s, const LaneMat3<Real8>& F, const LaneMat3<Real8>& L, Matrix9& A) {
    const LaneMat3<Real8> E = multiply(F, cofactor(L));
    const LaneVec3<Real8> e[3] = {E.c0, E.c1, E.c2};
    for (int m = 0; m < 3; ++m) {
        const int p = 3 * ((m + 1) % 3), q = 3 * ((m + 2) % 3);
        const auto add = [&](int i, int k, const Real8& x) {
            A.a[p + i][q + k] += x;
            A.a[q + k][p + i] += x;
            A.a[p + k][q + i] -= x;
            A.a[q + i][p + k] -= x;
        };
        add(0, 1, s * e[m].z);
        add(1, 2, s * e[m].x);
        add(2, 0, s * e[m].y);
    }
}

/// What turning the frame adds to H: kappa (X - R X^T R), an upper bound of (la (tr S - 3) - 2 mu) G^-1 on the modes that turn R, with
/// G = tr(S) I - S. Compressed, the modes are softened, but not below zero: a negative eigenvalue bends the path and bounds no step. The
/// eigenvalues of G lie within its mean -+ 2 spread; s_i + s_j is not taken below 1e-3, where the frame is about to jump.
Real8 frame_stiffness(const MaterialConstants& material, const LaneMat3<Real8>& F, const LaneMat3<Real8>& R) {
    constexpr Real least = 1e-3;
    const Real8 s00 = dot(R.c0, F.c0), s11 = dot(R.c1, F.c1), s22 = dot(R.c2, F.c2);
    const Real8 s01 = dot(R.c0, F.c1), s12 = dot(R.c1, F.c2), s20 = dot(R.c2, F.c0);
    const Real8 third = (s00 + s11 + s22) / 3.0, d0 = s00 - third, d1 = s11 - third, d2 = s22 - third;
    const Real8 spread = square_root((d0 * d0 + d1 * d1 + d2 * d2 + 2.0 * (s01 * s01 + s12 * s12 + s20 * s20)) / 6.0);
    const Real8 mean = 2.0 * third, c = material.lame_lambda * (3.0 * third - 3.0) - 2 * material.shear_modulus;
    const Real8 curvature = c > 0.0 ? mean - 2.0 * spread : mean + 2.0 * spread;
    const Real8 kappa = c / (curvature > least ? curvature : Real8{} + least);
    return kappa > -material.shear_modulus ? kappa : Real8{} - material.shear_modulus;
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

Real8 frequency_squared_bound(const MaterialConstants& material, const LaneMat3<Real8>& F, const Real8& volume, const LaneMat3<Real8>& Q,
                              LaneQuaternion<Real8>& q) {
    const Real mu = material.shear_modulus, la = material.lame_lambda;
    const LaneMat3<Real8> L = cholesky(Q);
    Matrix9 A{};
    if (material.model == MaterialModel::stable_neo_hookean) {
        const auto [mu_model, la_model] = stable_neo_hookean::model_moduli(material);
        const LaneMat3<Real8> cof = cofactor(F);
        const Real8 J = dot(F.c0, cof.c0), inverse = 1.0 / (inner_product(F, F) + 1.0), shear = mu_model - mu_model * inverse;
        // An element pressed together resists shear less than at rest, and at F = 0 not at all: a step that bounds nothing would be wrong as
        // soon as it opens, so that it counts as stiff as at rest.
        const Real at_rest = 0.75 * mu_model;
        add_identity(shear > at_rest ? shear : Real8{} + at_rest, L, A);
        add_dyad(2 * mu_model * (inverse * inverse), multiply(F, L), A);
        add_dyad(Real8{} + la_model, multiply(cof, L), A);
        add_cofactor_slope(la_model * (J - 1.0) - 0.75 * mu_model, F, L, A);
    } else {
        const bool turns = material.model == MaterialModel::corotational;
        if (turns) extract_rotation(F, volume, q);
        const LaneMat3<Real8> R = rotation_of(q);
        const LaneMat3<Real8> RL = turns ? multiply(R, L) : L;
        const Real8 kappa = turns ? frame_stiffness(material, F, R) : Real8{} - mu;  // linear: 2 mu on the symmetric part only
        add_identity(2 * mu + kappa, L, A);
        add_turned_transpose(-kappa, RL, A);
        add_dyad(Real8{} + la, RL, A);
    }
    const Real8 bound = volume * largest_eigenvalue_bound(A);
    return volume > 0.0 ? bound : Real8{};
}

}  // namespace skerry
