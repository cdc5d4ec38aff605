// Linear elasticity: valid for small strains and rotations. Large rotations cause false stress.
#pragma once

#include "components/material_table.h"
#include "systems/material/lane_math.h"
#include "systems/material/tangent.h"

namespace skerry {

/// systems/material/with_law.h describes the members of a material law.
struct Linear {
    static constexpr bool has_frame = false;
    static constexpr bool stiffness_varies = false;
    static constexpr int stress_flops = 18;

    /// Elastic energy Psi per rest volume: mu |e|^2 + lambda/2 (tr e)^2 with the strain e = (F + F^T)/2 - I [J/m^3].
    static Real energy_density(const MaterialConstants& material, const Mat3& F);

    /// First Piola-Kirchhoff stress dPsi/dF (docs/methods/elasticity.md 2.1) [Pa].
    static Mat3 stress(const MaterialConstants& material, const Mat3& F);

    /// Largest eigenvalue of dP/dF. It is the same for every deformation [Pa].
    static Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

    /// dP/dF, which does not depend on F [Pa].
    static Tangent tangent(const MaterialConstants& material, const Mat3& F);

    /// Elastic energy per rest volume in each lane [J/m^3].
    template <class T>
    static T energy_density(const MaterialConstants& material, const LaneMat3<T>& F) {
        const T exx = F.c0.x - 1.0, eyy = F.c1.y - 1.0, ezz = F.c2.z - 1.0;
        const T gxy = F.c1.x + F.c0.y, gyz = F.c2.y + F.c1.z, gzx = F.c0.z + F.c2.x;
        const T trace = exx + eyy + ezz;
        return material.shear_modulus *
                   (exx * exx + eyy * eyy + ezz * ezz + 0.5 * (gxy * gxy + gyz * gyz + gzx * gzx)) +
               (0.5 * material.lame_lambda) * (trace * trace);
    }

    template <class T>
    [[gnu::always_inline]] static LaneMat3<T> stress(const MaterialConstants& material, const LaneMat3<T>& F) {
        const Real mu = material.shear_modulus;
        const T exx = F.c0.x - 1.0, eyy = F.c1.y - 1.0, ezz = F.c2.z - 1.0;
        const T pressure = material.lame_lambda * (exx + eyy + ezz);
        const T sxy = mu * (F.c1.x + F.c0.y), syz = mu * (F.c2.y + F.c1.z), szx = mu * (F.c0.z + F.c2.x);
        return {{(2 * mu) * exx + pressure, sxy, szx},
                {sxy, (2 * mu) * eyy + pressure, syz},
                {szx, syz, (2 * mu) * ezz + pressure}};
    }

    /// Adds dP/dF to H. A change X of F is mapped to mu (X + X^T) + lambda tr(X) I.
    template <class T, class Terms>
    static void add_stiffness(const MaterialConstants& material, const LaneMat3<T>&, Terms& H) {
        H.add_identity(T{} + material.shear_modulus);
        H.add_turned_transpose(T{} + material.shear_modulus, IdentityMatrix{});
        H.add_dyad(T{} + material.lame_lambda, IdentityMatrix{});
    }
};

}  // namespace skerry
