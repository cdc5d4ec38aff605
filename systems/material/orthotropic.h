// Orthotropic elasticity: St. Venant-Kirchhoff law with the stiffness C. Energy density Psi = E : C : E / 2 and first
// Piola-Kirchhoff stress P = F (C : E), with Green's strain E = (F^T F - I)/2 (docs/methods/elasticity.md 2.6).
#pragma once

#include <array>

#include "components/material_table.h"
#include "systems/material/lane_math.h"
#include "systems/material/tangent.h"

namespace skerry {

/// Members are described in systems/material/with_law.h; orthotropic.cpp defines and instantiates the templates that
/// have no body here. The stiffness is C = mu sum_k M_k (x) M_k + lambda I (x) I with the matrices M_k of
/// MaterialConstants::strain_modes, the identity I, and (x) for the dyadic product.
struct Orthotropic {
    static constexpr bool has_frame = false;
    static constexpr bool stiffness_varies = true;
    static constexpr int stress_flops = 190;

    static Real energy_density(const MaterialConstants& material, const Mat3& F);
    static Mat3 stress(const MaterialConstants& material, const Mat3& F);
    static Real stiffness_bound(const MaterialConstants& material, const Mat3& F);
    static Tangent tangent(const MaterialConstants& material, const Mat3& F);

    /// Matrices D_k of dP/dF = sum_k D_k (x) D_k at the deformation gradient F, without the geometric stiffness (the
    /// term X S that the stress S adds for a change X of F) [Pa^(1/2)].
    static std::array<Mat3, 7> dyads(const MaterialConstants& material, const Mat3& F);
    /// Energy density of a symmetric strain [J/m^3].
    static Real energy_of_strain(const MaterialConstants& material, const Mat3& strain);

    template <class T>
    static T energy_density(const MaterialConstants& material, const LaneMat3<T>& F);
    template <class T>
    static LaneMat3<T> stress(const MaterialConstants& material, const LaneMat3<T>& F);
    template <class T>
    static T stiffness_bound(const MaterialConstants& material, const LaneMat3<T>& F) {
        return rough_stiffness_bound(material, inner_product(F, F), determinant(F));
    }
    /// Upper bound of the largest eigenvalue of dP/dF, from `square` = |F|^2 and `J` = det F alone [Pa].
    template <class T>
    static T rough_stiffness_bound(const MaterialConstants& material, const T& square, const T& J);

    /// Upper bound of dP/dF: mu sum_k D_k (x) D_k + lambda F (x) F with D_k = F M_k, plus `rest` times the identity.
    template <class T>
    struct Slope {
        std::array<LaneMat3<T>, 6> dyads;
        T rest;
    };
    template <class T>
    static Slope<T> slope(const MaterialConstants& material, const LaneMat3<T>& F);

    /// Adds an upper bound of dP/dF to H. It differs from dP/dF in two terms:
    /// - The geometric stiffness (due to the stress) is replaced by its largest eigenvalue times the identity, or by 0
    ///   if this eigenvalue is negative.
    /// - Compressed elements get additional stiffness, up to that of the rest shape, which they regain when they
    ///   expand.
    template <class T, class Terms>
    static void add_stiffness(const MaterialConstants& material, const LaneMat3<T>& F, Terms& H) {
        const Slope<T> part = slope(material, F);
        for (const LaneMat3<T>& dyad : part.dyads) H.add_dyad(T{} + material.shear_modulus, dyad);
        H.add_dyad(T{} + material.lame_lambda, F);
        H.add_identity(part.rest);
    }
};

/// Sets the elastic constants of an orthotropic material. Requires valid moduli: positive shear moduli, and a positive
/// definite compliance of the normal strains.
///
/// Its Lame constants become those of an isotropic material that is not stiffer than the orthotropic one for any
/// strain. They are used by the Maxwell elements, which model losses. If these were stiffer for some strain, the bound
/// on the stable step would not hold for them.
void set_orthotropic(const OrthotropicModuli& moduli, MaterialConstants& material);

/// Rotates the axes of an orthotropic material by `rotation`.
void turn_axes(const Mat3& rotation, MaterialConstants& material);

/// Stiffness of the three normal strains along the axes [Pa]: the inverse of the compliance. The moduli are valid if it
/// is positive definite.
Mat3 normal_stiffness(const OrthotropicModuli& moduli);

}  // namespace skerry
