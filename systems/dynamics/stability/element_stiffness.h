// Upper bound on the highest frequency of each element of a block in its present shape. A block is a group of eight
// elements, one in each lane of a vector (docs/methods/stable_step.md 3, 4).
#pragma once

#include "components/material_table.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/lane_math.h"
#include "systems/material/relaxation.h"

namespace skerry {

/// Viscous stiffness of an element in addition to the stiffness of its material law. Zero moduli mean no viscous
/// stiffness.
struct ViscousPart {
    ViscousModuli moduli{};
    ViscousStretch<Real8> stretch{};
    // `strain_share`: effective number of springs of the Maxwell elements; a spring that relaxes within the step counts
    // as a fraction of 1. `volume_share`: this fraction for the spring of the bulk viscosity.
    Real8 strain_share = Real8{} + Real{maxwell_count}, volume_share = Real8{} + 1.0;
};

/// Additional term b (R:X)^2 of the mass form of an element (frame_masses.h), with the gradient X of its displacements.
/// R is `rotation`, which approximates the rotation of the body.
struct FramePart {
    Mat3 rotation = Mat3::Identity();
    Real8 b{};  // [kg m^2]
};

/// Accuracy of frequency_squared_bound().
enum class Sharpness {
    trace,     // the bound is at most 15 % too large
    bisected,  // the bound is at most 0.3 % too large, but takes twice the time of `trace`
    compared,  // the bound is infinite unless the eigenvalues of all eight lanes are below `threshold`
    // The bound is one of `threshold`, 1.1 `threshold`, 1.21 `threshold` ... and at most 10 % too large. It is infinite
    // beyond about ten times `threshold`.
    stepped
};
/// Upper bound on the squared highest frequency lambda_max(M^-1/2 K M^-1/2) of each element [1/s^2]; 0 in lanes without
/// volume.
///
/// The stiffness is K = V G^T H G with the volume V, the gradients G at rest and H = dP/dF. The mass M depends on `Q`:
/// - `Q` is the sum of g_a g_a^T / m_a over the corners a, with their gradients g_a and mass shares m_a: M is the
///   diagonal matrix of the m_a.
/// - Any other `Q`: M is the mass form of `Q` (mass_forms.h).
/// - With `frame`, M has the additional term of FramePart.
///
/// If the material law has a corotational frame, `q` is the initial guess of the frame and receives the frame found. If
/// all eight lanes are below `threshold` [1/s^2], all lanes get `threshold` instead, in a tenth of the time.
Real8 frequency_squared_bound(const MaterialConstants& material, const LaneMat3<Real8>& F, const ViscousPart& viscous,
                              const Real8& volume, const LaneMat3<Real8>& Q, LaneQuaternion<Real8>& q,
                              Real threshold = 0, Sharpness sharpness = Sharpness::trace,
                              const FramePart* frame = nullptr);

}  // namespace skerry
