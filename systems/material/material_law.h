// Material laws for one element at a time, and the material constants of every law.
#pragma once

#include "components/material_table.h"
#include "components/types.h"
#include "systems/material/tangent.h"

namespace skerry {

/// Energy density [J/m^3], first Piola-Kirchhoff stress [Pa], and upper bound of the largest eigenvalue of dP/dF [Pa]
/// of a material at the deformation gradient F. These functions treat one element at a time. They are the reference
/// with which tests compare the kernels, and implicit bodies of large strain use them.
Real energy_density(const MaterialConstants& material, const Mat3& F);
Mat3 stress(const MaterialConstants& material, const Mat3& F);
Real stiffness_bound(const MaterialConstants& material, const Mat3& F);
/// Derivative dP/dF of the stress by the deformation gradient, for Newton steps [Pa].
Tangent tangent(const MaterialConstants& material, const Mat3& F);

/// Energy density at small strain for the displacement gradient `change` [J/m^3]. Anisotropic laws compute it by their
/// member energy_of_strain. For all other laws it is that of the law Linear, with which they agree at small strain.
Real small_strain_energy(const MaterialConstants& material, const Mat3& change);
/// Block -df_k/dx_l of the stiffness matrix at small strain, per volume, with the force f_k on node k and the position
/// x_l of node l [Pa/m^2]. `g` and `other` are the shape function gradients of nodes k and l [1/m]. Anisotropic laws
/// use their member `dyads`.
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
