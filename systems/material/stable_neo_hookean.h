// Stable neo-Hookean elasticity (Smith, de Goes, Kim 2018): finite for every F, inverted or flat. Psi = mu/2 (Ic - 3) +
// la/2 (J - alpha)^2 - mu/2 log(Ic + 1) with Ic = |F|^2 and alpha = 1 + 3 mu / (4 la), less its value at rest.
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"
#include "systems/material/tangent.h"

namespace skerry {

/// The members of a law are described in systems/material/with_law.h.
struct StableNeoHookean {
    static constexpr bool has_frame = false;
    static constexpr bool stiffness_varies = true;
    static constexpr int stress_flops = 82;

    /// Parameters mu and lambda of the model that give the small-strain moduli (Smith 2018, section 3.4;
    /// docs/methods/elasticity.md 2.3) [Pa]. For every Poisson ratio above -1 la > mu / 8, so that alpha lies between 1
    /// and 7.
    struct ModelModuli {
        Real mu, la;
    };
    static ModelModuli model_moduli(const MaterialConstants& material) {
        return {4.0 / 3 * material.shear_modulus, material.lame_lambda + 5.0 / 6 * material.shear_modulus};
    }

    /// Elastic energy per rest volume: mu/2 (Ic - 3 - log((Ic + 1) / 4)) - 3/4 mu (J - 1) + la/2 (J - 1)^2; 0 at rest
    /// [J/m^3].
    static Real energy_density(const MaterialConstants& material, const Mat3& F);

    /// First Piola-Kirchhoff stress: mu (1 - 1 / (Ic + 1)) F + (la (J - 1) - 3/4 mu) cof F [Pa].
    static Mat3 stress(const MaterialConstants& material, const Mat3& F);

    /// Upper bound of the largest eigenvalue of dP/dF: 9/8 mu + la |cof F|^2 + 2/sqrt(3) |la (J - 1) - 3/4 mu| |F|
    /// (docs/methods/stable_step.md 4.3) [Pa]. The first term is the maximum of mu (1 - 1 / (Ic + 1)) + 2 mu Ic / (Ic +
    /// 1)^2, at Ic = 3.
    static Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

    /// dP/dF [Pa]. With a = mu (1 - 1/(Ic + 1)), p = la (J - 1) - 3/4 mu and c the stretches of cof F: a 1 + 2 mu/(Ic +
    /// 1)^2 s s^T + la c c^T + p s_k on the stretches i, j, a - p s_k on a flip, a + p s_k on a twist.
    static Tangent tangent(const MaterialConstants& material, const Mat3& F);

    /// The law by lanes.
    template <class T>
    static T energy_density(const MaterialConstants& material, const LaneMat3<T>& F) {
        const auto [mu, la] = model_moduli(material);
        // Computed from e = F - 1 without the first-order terms, which cancel: otherwise a body at rest would have the
        // energy of their rounding.
        const T xx = F.c0.x - 1.0, yy = F.c1.y - 1.0, zz = F.c2.z - 1.0;
        const T trace = xx + yy + zz;
        const LaneMat3<T> e{{xx, F.c0.y, F.c0.z}, {F.c1.x, yy, F.c1.z}, {F.c2.x, F.c2.y, zz}};
        const T minors = (xx * yy - e.c0.y * e.c1.x) + (xx * zz - e.c0.z * e.c2.x) + (yy * zz - e.c1.z * e.c2.y);
        const T bulk = minors + dot(e.c0, cross(e.c1, e.c2)), square = inner_product(e, e);
        const T growth = trace + bulk, quarter = 0.25 * (2.0 * trace + square);  // J - 1, (Ic - 3) / 4
        return mu * (0.375 * square - 0.75 * bulk - 0.5 * (log_of_one_plus(quarter) - quarter)) +
               (0.5 * la) * (growth * growth);
    }

    template <class T>
    static SplitStress<T> stress(const MaterialConstants& material, const LaneMat3<T>& F) {
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

    /// Upper bound of stiffness_bound from |F|^2 and det F: |cof F|^2 <= |F|^4/3, 2/sqrt(3) |F| <= |F|^2/3 + 1. Equal
    /// at rest.
    template <class T>
    static T rough_stiffness_bound(const MaterialConstants& material, const T& square, const T& J) {
        const auto [mu, la] = model_moduli(material);
        const T slope = la * (J - 1.0) - 0.75 * mu;
        return 1.125 * mu + (la / 3) * (square * square) + (slope < 0.0 ? -slope : slope) * (square * (1.0 / 3) + 1.0);
    }

    /// Upper bound of dP/dF: mu (1 - 1 / (Ic + 1)) X + 2 mu / (Ic + 1)^2 (F : X) F + la (cof F : X) cof F + (la (J - 1)
    /// - 3/4 mu) d(cof F). A compressed element resists shear less than at rest, and not at all at F = 0. A step
    /// without a bound would be wrong as soon as the element opens, so the shear stiffness is at least that at rest.
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
