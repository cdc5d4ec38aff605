// Energy norm of stresses.
#pragma once

#include <Eigen/Dense>

#include "components/material_table.h"
#include "components/types.h"

namespace skerry {

/// Coordinates of a stress. The scalar product of the coordinates of two stresses s and t is s : C^-1 : t, with the
/// stiffness C at small strain. The last coordinate belongs to the volumetric part.
using StressCoordinates = Eigen::Matrix<Real, 7, 1>;

/// Computes the coordinates of stresses in one material.
class EnergyNorm {
public:
    /// `splits`: true if some elements exert only one part of the stress (ElementPart).
    EnergyNorm(const MaterialConstants& material, bool splits);

    /// Coordinates of a stress that belongs to `part` of the material law. `turn`: rotation of the material axes, used
    /// for anisotropic materials.
    StressCoordinates of(const Mat3& stress, ElementPart part, const Mat3& turn) const;

private:
    bool is_anisotropic_;
    // Factors for isotropic materials. `of_shear_`, `of_volume_`: square roots of the compliances of the deviatoric and
    // of the volumetric part of a stress [Pa^(-1/2)]. A complete stress has a volumetric part with the pressure
    // `pressure_` times the trace of the stress.
    Real of_shear_ = 0, of_volume_ = 0, pressure_ = 0;
    // For an anisotropic material: matrix that maps the entries xx, yy, zz, xy, yz, zx of a stress to its coordinates.
    // It is the inverse of the Cholesky factor of the stiffness [Pa^(-1/2)].
    Eigen::Matrix<Real, 6, 6> of_all_ = Eigen::Matrix<Real, 6, 6>::Zero();
};

}  // namespace skerry
