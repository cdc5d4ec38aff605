// What holds for every constitutive law: choice by model, and wave speeds.
#pragma once

#include "components/material_table.h"
#include "components/types.h"

namespace skerry {

/// Energy density (J/m^3), first Piola-Kirchhoff stress (Pa) and a bound on the largest eigenvalue of dP/dF (Pa) of a material at F. One
/// element at a time: the plain twin of the kernels, for tests.
Real energy_density(const MaterialConstants& material, const Mat3& F);
Mat3 stress(const MaterialConstants& material, const Mat3& F);
Real stiffness_bound(const MaterialConstants& material, const Mat3& F);

/// Speeds of small waves, m/s (methods.md 8.12).
Real pressure_wave_speed(const MaterialConstants& material);  // sqrt((lambda + 2 mu) / rho)
Real shear_wave_speed(const MaterialConstants& material);     // sqrt(mu / rho)
Real bar_wave_speed(const MaterialConstants& material);       // sqrt(E / rho), along a thin bar

/// The constants from what users give: E > 0 (Pa), -1 < nu < 0.5, rho > 0 (kg/m^3).
MaterialConstants material_constants(MaterialModel model, Real young_modulus, Real poisson_ratio, Real density);

}  // namespace skerry
