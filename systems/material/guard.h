// Inversion barrier: an energy that keeps a tetrahedron from inverting. Psi = k/2 (J0 - J)^2 if J = det F is below J0,
// else zero, with the stiffness k (docs/methods/elasticity.md 7.7).
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"
#include "systems/material/tangent.h"

namespace skerry {

/// systems/material/with_law.h describes the members of a material law. The stiffness k of the barrier is stored as the
/// Lame constant lambda.
struct Guard {
    static constexpr bool has_frame = false;
    static constexpr bool stiffness_varies = true;
    static constexpr int stress_flops = 36;

    /// J0: ratio of present volume to rest volume below which the barrier acts.
    static constexpr Real barrier_ratio = 0.5;

    /// Elastic energy per rest volume: k/2 (J0 - J)^2 if J = det F is below J0, else zero [J/m^3].
    static Real energy_density(const MaterialConstants& material, const Mat3& F);

    /// First Piola-Kirchhoff stress while J = det F is below J0: -k (J0 - J) cof F [Pa].
    static Mat3 stress(const MaterialConstants& material, const Mat3& F);

    /// Upper bound of the largest eigenvalue of dP/dF while J = det F is below J0 [Pa], else 0:
    ///     k |cof F|^2 + 2/sqrt(3) k (J0 - J) |F|     (docs/methods/stable_step.md 4.3)
    static Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

    /// dP/dF in the form of Tangent while J = det F is below J0 [Pa]. Symbols: p = -k (J0 - J), the stretches s of F,
    /// the stretches c of cof F, and the axis m other than i and j:
    ///     normal_ii = k c_i^2
    ///     normal_ij = k c_i c_j + p s_m
    ///     flip_m    = -p s_m
    ///     twist_m   = p s_m
    /// Negative eigenvalues are then set to zero.
    static Tangent tangent(const MaterialConstants& material, const Mat3& F);

    /// Elastic energy per rest volume in each lane [J/m^3].
    template <class T>
    static T energy_density(const MaterialConstants& material, const LaneMat3<T>& F) {
        const T missing = missing_of(determinant(F));
        return (0.5 * material.lame_lambda) * (missing * missing);
    }

    template <class T>
    [[gnu::always_inline]] static LaneMat3<T> stress(const MaterialConstants& material, const LaneMat3<T>& F) {
        const LaneMat3<T> cof = cofactor(F);
        return (-material.lame_lambda * missing_of(dot(F.c0, cof.c0))) * cof;
    }

    template <class T>
    static T stiffness_bound(const MaterialConstants& material, const LaneMat3<T>& F) {
        constexpr Real two_over_root_three = 1.1547005383792515;
        const LaneMat3<T> cof = cofactor(F);
        const T missing = missing_of(dot(F.c0, cof.c0));
        const T bound = inner_product(cof, cof) + two_over_root_three * (missing * square_root(inner_product(F, F)));
        return missing > 0.0 ? T(material.lame_lambda * bound) : T{};
    }

    /// Upper bound of stiffness_bound, computed from `square` = |F|^2 and `J` = det F alone. It uses the inequalities
    /// |cof F|^2 <= |F|^4/3 and 2/sqrt(3) |F| <= |F|^2/3 + 1.
    template <class T>
    static T rough_stiffness_bound(const MaterialConstants& material, const T& square, const T& J) {
        const T missing = missing_of(J);
        const T bound = (square * square) * (1.0 / 3) + missing * (square * (1.0 / 3) + 1.0);
        return missing > 0.0 ? T(material.lame_lambda * bound) : T{};
    }

    /// Adds dP/dF to H. With J = det F, a change X of F is mapped to k (cof F : X) cof F - k (J0 - J) d(cof F), where
    /// d(cof F) is the change of cof F.
    template <class T, class Terms>
    static void add_stiffness(const MaterialConstants& material, const LaneMat3<T>& F, Terms& H) {
        const LaneMat3<T> cof = cofactor(F);
        const T missing = missing_of(dot(F.c0, cof.c0));
        H.add_dyad(missing > 0.0 ? T{} + material.lame_lambda : T{}, cof);
        H.add_cofactor_slope(-material.lame_lambda * missing, F);
    }

private:
    template <class T>
    static T missing_of(const T& J) {
        const T missing = barrier_ratio - J;
        return missing < 0.0 ? T{} : missing;  // the comparison is false for NaN, so the result is NaN if J is NaN
    }
};

}  // namespace skerry
