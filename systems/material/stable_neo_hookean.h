// Stable neo-Hookean elasticity (Smith, de Goes, Kim 2018; docs/methods/elasticity.md 2.3). The energy density is
// finite for every deformation gradient F, also for inverted and flat elements.
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"
#include "systems/material/tangent.h"

namespace skerry {

/// systems/material/with_law.h describes the members of a material law.
struct StableNeoHookean {
    static constexpr bool has_frame = false;
    static constexpr bool stiffness_varies = true;
    static constexpr int stress_flops = 82;

    /// Parameters mu and lambda of the model [Pa]. They give the model the Lame constants of the material at small
    /// strain (Smith 2018, section 3.4; docs/methods/elasticity.md 2.3). For every Poisson ratio above -1, la is
    /// greater than mu / 8, so it is positive.
    struct ModelModuli {
        Real mu, la;
    };
    static ModelModuli model_moduli(const MaterialConstants& material) {
        return {4.0 / 3 * material.shear_modulus, material.lame_lambda + 5.0 / 6 * material.shear_modulus};
    }

    /// Elastic energy per rest volume, 0 in the rest shape, with Ic = |F|^2 and J = det F [J/m^3]:
    ///     mu/2 (Ic - 3 - log((Ic + 1) / 4)) - 3/4 mu (J - 1) + la/2 (J - 1)^2
    static Real energy_density(const MaterialConstants& material, const Mat3& F);

    /// First Piola-Kirchhoff stress, with Ic = |F|^2 and J = det F [Pa]:
    ///     mu (1 - 1/(Ic + 1)) F + (la (J - 1) - 3/4 mu) cof F
    static Mat3 stress(const MaterialConstants& material, const Mat3& F);

    /// Upper bound of the largest eigenvalue of dP/dF (docs/methods/stable_step.md 4.3) [Pa]. With J = det F and Ic =
    /// |F|^2:
    ///     9/8 mu + la |cof F|^2 + 2/sqrt(3) |la (J - 1) - 3/4 mu| |F|
    /// 9/8 mu is the maximum of mu (1 - 1/(Ic + 1)) + 2 mu Ic/(Ic + 1)^2 over Ic, reached at Ic = 3.
    static Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

    /// dP/dF in the form of Tangent, with negative eigenvalues set to zero [Pa]. Symbols:
    /// - stretches s of F, stretches c of cof F, axis k other than i and j
    /// - Ic = |F|^2, J = det F, a = mu (1 - 1/(Ic + 1)), p = la (J - 1) - 3/4 mu
    ///
    /// Entries:
    ///     normal_ii = a + 2 mu/(Ic + 1)^2 s_i^2 + la c_i^2
    ///     normal_ij = 2 mu/(Ic + 1)^2 s_i s_j + la c_i c_j + p s_k
    ///     flip_k    = a - p s_k
    ///     twist_k   = a + p s_k
    static Tangent tangent(const MaterialConstants& material, const Mat3& F);

    /// Elastic energy per rest volume in each lane [J/m^3].
    template <class T>
    static T energy_density(const MaterialConstants& material, const LaneMat3<T>& F) {
        const auto [mu, la] = model_moduli(material);
        // Computes the energy from e = F - I without the first-order terms, which cancel. With these terms a body in
        // its rest shape would have the energy of their rounding errors.
        const T xx = F.c0.x - 1.0, yy = F.c1.y - 1.0, zz = F.c2.z - 1.0;
        const T trace = xx + yy + zz;
        const LaneMat3<T> e{{xx, F.c0.y, F.c0.z}, {F.c1.x, yy, F.c1.z}, {F.c2.x, F.c2.y, zz}};
        const T minors = (xx * yy - e.c0.y * e.c1.x) + (xx * zz - e.c0.z * e.c2.x) + (yy * zz - e.c1.z * e.c2.y);
        const T bulk = minors + dot(e.c0, cross(e.c1, e.c2)), square = inner_product(e, e);
        // `growth` is J - 1, `quarter` is (Ic - 3) / 4, with J = det F and Ic = |F|^2.
        const T growth = trace + bulk, quarter = 0.25 * (2.0 * trace + square);
        return mu * (0.375 * square - 0.75 * bulk - 0.5 * (log_of_one_plus(quarter) - quarter)) +
               (0.5 * la) * (growth * growth);
    }

    template <class T>
    [[gnu::always_inline]] static SplitStress<T> stress(const MaterialConstants& material, const LaneMat3<T>& F) {
        const auto [mu, la] = model_moduli(material);
        const LaneMat3<T> cof = cofactor(F);
        const T shear = mu - mu / (inner_product(F, F) + 1.0);
        const T pressure = la * (dot(F.c0, cof.c0) - 1.0) - 0.75 * mu;
        return {shear, pressure, cof};
    }

    template <class T>
    static T stiffness_bound(const MaterialConstants& material, const LaneMat3<T>& F) {
        constexpr Real two_over_root_three = 1.1547005383792515;
        const auto [mu, la] = model_moduli(material);
        const LaneMat3<T> cof = cofactor(F);
        const T slope = la * (dot(F.c0, cof.c0) - 1.0) - 0.75 * mu;
        return 1.125 * mu + la * inner_product(cof, cof) +
               two_over_root_three * square_root(slope * slope * inner_product(F, F));
    }

    /// Upper bound of stiffness_bound, computed from `square` = |F|^2 and `J` = det F alone. It uses the inequalities
    /// |cof F|^2 <= |F|^4/3 and 2/sqrt(3) |F| <= |F|^2/3 + 1. In the rest shape this bound equals stiffness_bound.
    template <class T>
    static T rough_stiffness_bound(const MaterialConstants& material, const T& square, const T& J) {
        const auto [mu, la] = model_moduli(material);
        const T slope = la * (J - 1.0) - 0.75 * mu;
        return 1.125 * mu + (la / 3) * (square * square) + (slope < 0.0 ? -slope : slope) * (square * (1.0 / 3) + 1.0);
    }

    /// Adds an upper bound of dP/dF to H. It is dP/dF itself (docs/methods/stable_step.md 4.3), except that the
    /// coefficient of the identity, mu (1 - 1/(|F|^2 + 1)), is raised to 3/4 mu, its value in the rest shape, if it is
    /// smaller.
    ///
    /// Under compression this coefficient decreases to zero at F = 0. A step length computed from so small a stiffness
    /// would be too long as soon as the element expands again.
    template <class T, class Terms>
    static void add_stiffness(const MaterialConstants& material, const LaneMat3<T>& F, Terms& H) {
        const auto [mu, la] = model_moduli(material);
        const LaneMat3<T> cof = cofactor(F);
        const T J = dot(F.c0, cof.c0), inverse = 1.0 / (inner_product(F, F) + 1.0), shear = mu - mu * inverse;
        const Real at_rest = 0.75 * mu;
        H.add_identity(shear > at_rest ? shear : T{} + at_rest);
        H.add_dyad(2 * mu * (inverse * inverse), F);
        H.add_dyad(T{} + la, cof);
        H.add_cofactor_slope(la * (J - 1.0) - 0.75 * mu, F);
    }
};

}  // namespace skerry
