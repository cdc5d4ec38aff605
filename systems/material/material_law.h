// A material of any law: its constants, and the laws one element at a time.
#pragma once

#include "components/material_table.h"
#include "components/types.h"
#include "systems/material/tangent.h"

namespace skerry {

/// Energy density (J/m^3), first Piola-Kirchhoff stress (Pa) and a bound on the largest eigenvalue of dP/dF (Pa) of a
/// material at F. One element at a time: the plain twin of the kernels, for tests and implicit bodies of large strain.
Real energy_density(const MaterialConstants& material, const Mat3& F);
Mat3 stress(const MaterialConstants& material, const Mat3& F);
Real stiffness_bound(const MaterialConstants& material, const Mat3& F);
/// dP/dF (Pa) for Newton steps.
Tangent tangent(const MaterialConstants& material, const Mat3& F);

/// The constants from what users give: E > 0 (Pa), -1 < nu < 0.5, rho > 0 (kg/m^3).
MaterialConstants material_constants(MaterialModel model, Real young_modulus, Real poisson_ratio, Real density);

}  // namespace skerry
