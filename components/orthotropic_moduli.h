// Engineering constants of an orthotropic material (docs/methods/elasticity.md 2.6).
#pragma once

#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Elastic constants along the three orthogonal axes of an orthotropic material. Under a stress along axis i alone, the
/// strain along axis j is -nu_ij times the strain along axis i.
struct OrthotropicModuli {
    Vec3 young_modulus = Vec3::Constant(1e5);  // E_1, E_2, E_3, > 0 [Pa]
    Vec3 poisson_ratio = Vec3::Constant(0.3);  // nu_12, nu_23, nu_13
    Vec3 shear_modulus = Vec3::Constant(4e4);  // G_12, G_23, G_13, > 0 [Pa]
    // Directions of the first and second axis in the mesh, of any length. The second is made orthogonal to the first.
    Vec3 first_axis = Vec3::UnitX(), second_axis = Vec3::UnitY();

    bool operator==(const OrthotropicModuli&) const = default;
};

}  // namespace skerry
#pragma GCC visibility pop
