// Law of Ogden (1972) for rubber, with separate terms for changes of shape and of volume (docs/methods/elasticity.md
// 2.5). With the stretches s_i, J = det F, the bulk modulus K, exponents a_p, and shares c_p of the shear modulus mu,
// whose sum is 1, the energy density is
//     Psi = sum_p 2 mu c_p / a_p^2 (sum_i (s_i / J^(1/3))^a_p - 3) + K/2 (J - 1)^2
// Special cases are the laws neo-Hookean (one term of exponent 2), Mooney-Rivlin (exponents 2 and -2) and Hencky (limit
// of one term of exponent 0).
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_power.h"
#include "systems/material/principal_axes.h"
#include "systems/material/tangent.h"

namespace skerry {

/// systems/material/with_law.h describes the members of a material law. ogden.cpp defines and instantiates the
/// templates that have no body here.
struct Ogden {
    static constexpr bool has_frame = false;
    static constexpr bool stiffness_varies = true;
    static constexpr int stress_flops = 900;  // for three terms

    // The law is singular at zero stretch. A stretch x below the limit least_stretch acts as the positive number
    // limit^2 / (2 limit - x). J below the limit least_volume is replaced in the same way. So energy and stress are
    // finite for every F, and the stress is continuous.
    static constexpr Real least_stretch = 0.05, least_volume = 0.2;

    /// Bulk modulus K = lambda + 2/3 mu at small strain [Pa].
    static Real bulk_modulus(const MaterialConstants& material) {
        return material.lame_lambda + 2.0 / 3 * material.shear_modulus;
    }

    static Real energy_density(const MaterialConstants& material, const Mat3& F);
    static Mat3 stress(const MaterialConstants& material, const Mat3& F);
    static Real stiffness_bound(const MaterialConstants& material, const Mat3& F);
    static Tangent tangent(const MaterialConstants& material, const Mat3& F);

    template <class T>
    static T energy_density(const MaterialConstants& material, const LaneMat3<T>& F);
    template <class T>
    static LaneMat3<T> stress(const MaterialConstants& material, const LaneMat3<T>& F);
    /// Upper bound of the largest eigenvalue of dP/dF, from its entries in principal axes [Pa].
    template <class T>
    static T stiffness_bound(const MaterialConstants& material, const LaneMat3<T>& F);
    /// Upper bound of stiffness_bound, from `square` = |F|^2 and `J` = det F alone (docs/methods/stable_step.md 4.5)
    /// [Pa]. It is infinite if J is below least_volume or a stretch may be below least_stretch.
    template <class T>
    static T rough_stiffness_bound(const MaterialConstants& material, const T& square, const T& J);

    /// Upper bound of that part of dP/dF which is due to the energy of shape changes [Pa]. R is the rotation nearest to
    /// F. A change X = X_e + X_o of F consists of a stretch X_e and a rotation X_o: R^T X_e is the symmetric part of
    /// R^T X, R^T X_o its skew part. The bound is the quadratic form
    ///     even |X_e|^2 + odd |X_o|^2 - volume (R : X)^2
    template <class T>
    struct FrameBound {
        LaneMat3<T> R;
        T even, odd;
        Real volume;
    };
    template <class T>
    static FrameBound<T> frame_bound(const MaterialConstants& material, const LaneMat3<T>& F);

    /// Adds an upper bound of dP/dF to H. The part due to the energy of shape changes is never taken below its value in
    /// the rest shape, because a compressed element regains this stiffness when it expands.
    template <class T, class Terms>
    static void add_stiffness(const MaterialConstants& material, const LaneMat3<T>& F, Terms& H) {
        const FrameBound<T> bound = frame_bound(material, F);
        const LaneMat3<T> cof = cofactor(F);
        const Real K = bulk_modulus(material);
        H.add_identity(0.5 * (bound.even + bound.odd));
        H.add_turned_transpose(0.5 * (bound.even - bound.odd), bound.R);
        H.add_dyad(T{} - bound.volume, bound.R);
        H.add_dyad(T{} + K, cof);
        H.add_cofactor_slope(K * (dot(F.c0, cof.c0) - 1.0), F);
    }
};

}  // namespace skerry
