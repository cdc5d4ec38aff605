// Corotational elasticity: linear elasticity in a frame that rotates with the element.
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"
#include "systems/material/tangent.h"

namespace skerry {

/// systems/material/with_law.h describes the members of a material law.
struct Corotational {
    static constexpr bool has_frame = true;
    static constexpr bool stiffness_varies = false;
    static constexpr int stress_flops = 47;

    /// Elastic energy per rest volume: mu |F - R|^2 + lambda/2 (tr(R^T F) - 3)^2, with R the rotation nearest to the
    /// deformation gradient F [J/m^3].
    static Real energy_density(const MaterialConstants& material, const Mat3& F);

    /// First Piola-Kirchhoff stress, with R the rotation nearest to F: 2 mu (F - R) + lambda (tr(R^T F) - 3) R
    /// (docs/methods/elasticity.md 2.2) [Pa].
    static Mat3 stress(const MaterialConstants& material, const Mat3& F);

    /// Largest eigenvalue of dP/dF [Pa] (docs/methods/stable_step.md 4.2), with the rotation R nearest to F, S = R^T F,
    /// and the singular values s of F, the smallest with the sign of det F:
    ///     max(2 mu + 3 lambda, 2 mu + (lambda (tr S - 3) - 2 mu) 2/(s_i + s_j))     for all pairs i, j
    /// R is not unique if a sum s_i + s_j is 0. The eigenvalue is then infinite if lambda (tr S - 3) - 2 mu is
    /// positive.
    static Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

    /// dP/dF in the form of Tangent [Pa], with the rotation R nearest to F, S = R^T F, and the stretches s:
    ///     normal  = 2 mu I + lambda 1 1^T
    ///     flip_k  = 2 mu
    ///     twist_k = 2 mu + (lambda (tr S - 3) - 2 mu) 2/(s_i + s_j), where i and j are the axes other than k.
    /// The second term of `twist` arises because R rotates with F.
    static Tangent tangent(const MaterialConstants& material, const Mat3& F);

    /// Elastic energy per rest volume in each lane, for the given rotation R nearest to F [J/m^3].
    template <class T>
    static T energy_density(const MaterialConstants& material, const LaneMat3<T>& F, const LaneMat3<T>& R) {
        const LaneMat3<T> strain = F - R;
        const T trace = inner_product(R, strain);
        return material.shear_modulus * inner_product(strain, strain) + (0.5 * material.lame_lambda) * (trace * trace);
    }

    template <class T>
    [[gnu::always_inline]] static SplitStress<T> stress(const MaterialConstants& material, const LaneMat3<T>& F,
                                                        const LaneMat3<T>& R) {
        return stress(material, R, inner_product(R, F));
    }
    /// First Piola-Kirchhoff stress in each lane, for a given trace of R^T F [Pa].
    template <class T>
    [[gnu::always_inline]] static SplitStress<T> stress(const MaterialConstants& material, const LaneMat3<T>& R,
                                                        const T& trace) {
        // Near the rest shape the terms 2 mu F and -2 mu R nearly cancel. So the stress, however small, has a rounding
        // error of about the machine epsilon times 2 mu.
        const Real two_mu = 2 * material.shear_modulus;
        const T pressure = material.lame_lambda * (trace - 3.0);
        return {T{} + two_mu, pressure - two_mu, R};
    }

    /// Adds an upper bound of dP/dF to H (docs/methods/stable_step.md 4.2). With the rotation R nearest to F, the bound
    /// maps a change X of F to
    ///     2 mu X + lambda (R : X) R + kappa (X - R X^T R)
    /// The term with kappa bounds the stiffness due to the rotation of the frame R with F.
    template <class T, class Terms>
    static void add_stiffness(const MaterialConstants& material, const LaneMat3<T>& F, const LaneMat3<T>& R, Terms& H) {
        const T kappa = frame_stiffness(material, F, R);
        H.add_identity(2 * material.shear_modulus + kappa);
        H.add_turned_transpose(-kappa, R);
        H.add_dyad(T{} + material.lame_lambda, R);
    }

private:
    /// Returns kappa for the upper bound of dP/dF (docs/methods/stable_step.md 4.2). The term kappa (X - R X^T R) of
    /// the bound, for a change X of F, bounds the stiffness that arises because the frame R, the rotation nearest to F,
    /// rotates with F. kappa is c divided by a bound on the sums s_i + s_j of two stretches, with c =
    /// lambda (tr S - 3) - 2 mu and S = R^T F.
    template <class T>
    static T frame_stiffness(const MaterialConstants& material, const LaneMat3<T>& F, const LaneMat3<T>& R) {
        constexpr Real least = 1e-3;  // lower limit of a sum s_i + s_j; R is not unique if a sum is 0
        const T s00 = dot(R.c0, F.c0), s11 = dot(R.c1, F.c1), s22 = dot(R.c2, F.c2);
        const T s01 = dot(R.c0, F.c1), s12 = dot(R.c1, F.c2), s20 = dot(R.c2, F.c0);
        const T third = (s00 + s11 + s22) / 3.0, d0 = s00 - third, d1 = s11 - third, d2 = s22 - third;
        const T spread = square_root((d0 * d0 + d1 * d1 + d2 * d2 + 2.0 * (s01 * s01 + s12 * s12 + s20 * s20)) / 6.0);
        const T mean = 2.0 * third, c = material.lame_lambda * (3.0 * third - 3.0) - 2 * material.shear_modulus;
        // The sums differ by at most 2 spread from their mean. For c > 0 the least possible sum is the bound, otherwise
        // the greatest.
        const T curvature = c > 0.0 ? mean - 2.0 * spread : mean + 2.0 * spread;
        const T kappa = c / (curvature > least ? curvature : T{} + least);
        // Under compression kappa is negative. The limit -mu keeps the stiffness 2 mu + 2 kappa non-negative; a
        // negative stiffness causes no vibration, so it does not limit the step.
        return kappa > -material.shear_modulus ? kappa : T{} - material.shear_modulus;
    }
};

}  // namespace skerry
