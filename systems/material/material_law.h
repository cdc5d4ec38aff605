// Material laws for one element at a time, and the material constants of every law.
#pragma once

#include "components/material_table.h"
#include "components/types.h"
#include "systems/material/tangent.h"

namespace skerry {

/// Energy density [J/m^3], first Piola-Kirchhoff stress [Pa], and upper bound of the largest eigenvalue of dP/dF [Pa]
/// of a material at the deformation gradient F. These functions treat one element at a time. They are the simple
/// reference for the kernels, used in tests and for implicit bodies of large strain.
Real energy_density(const MaterialConstants& material, const Mat3& F);
Mat3 stress(const MaterialConstants& material, const Mat3& F);
Real stiffness_bound(const MaterialConstants& material, const Mat3& F);
/// Derivative dP/dF of the stress by the deformation gradient, for Newton steps [Pa].
Tangent tangent(const MaterialConstants& material, const Mat3& F);

/// Energy density [J/m^3] for the displacement gradient `change`, and block -df_k/dx_l of the stiffness matrix per
/// volume [Pa/m^2] of two nodes with the shape gradients g and other [1/m], both at small strain. Anisotropic laws
/// compute them by their members energy_of_strain and dyads; all other laws agree with Linear at small strain.
Real small_strain_energy(const MaterialConstants& material, const Mat3& change);
Mat3 small_strain_stiffness(const MaterialConstants& material, const Vec3& g, const Vec3& other);

/// Converts user parameters to material constants: Young's modulus > 0 [Pa], -1 < Poisson ratio < 0.5, density > 0
/// [kg/m^3].
MaterialConstants material_constants(MaterialModel model, Real young_modulus, Real poisson_ratio, Real density);

struct IsotropicModuli {
    Real young_modulus;  // [Pa]
    Real poisson_ratio;
};
/// Young's modulus and Poisson's ratio of the Lame constants.
IsotropicModuli isotropic_moduli(const MaterialConstants& material);

}  // namespace skerry
