// Rigorous bound on the highest frequency of one element in its present shape, element_lanes elements side by side
// (docs/methods/stable_step.md 3, 4).
#pragma once

#include "components/material_table.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/lane_math.h"
#include "systems/material/relaxation.h"

namespace skerry {

/// Viscous stiffness of an element in addition to its law; moduli of zero: none.
struct ViscousPart {
    ViscousModuli moduli{};
    ViscousStretch<Real8> stretch{};
    Real8 strain_share = Real8{} + 1.0, volume_share = Real8{} + 1.0;  // parts of the moduli that count
};

/// Mass b (R:X)^2 of an element, with the gradient X of displacements, in addition to that of Q (frame_masses.h).
struct FramePart {
    Mat3 rotation = Mat3::Identity();
    Real8 b{};  // [kg m^2]
};

/// Upper bound on lambda_max(M^-1/2 K M^-1/2) of each element [1/s^2]. K = V G^T H G with the rest gradients G and H =
/// dP/dF at F; M are the corners' shares of mass; `Q` = sum over the corners of g_a g_a^T / m_a. With `frame` elements
/// have that mass, too. `q` is the start of the frame of an element whose law has one, and is left at the frame found.
/// Lanes without volume get 0. If all eight lanes are below `enough` [1/s^2] they get `enough`, in a tenth of the time.
enum class Sharpness {
    trace,     // at most 15 % too large
    bisected,  // at most 0.3 % too large, in twice the time
    compared,  // infinity unless all eight lanes are below `enough`
    stepped    // at most 10 % too large, in steps of 10 % from `enough` on; infinity beyond ten times `enough`
};
Real8 frequency_squared_bound(const MaterialConstants& material, const LaneMat3<Real8>& F, const ViscousPart& viscous,
                              const Real8& volume, const LaneMat3<Real8>& Q, LaneQuaternion<Real8>& q, Real enough = 0,
                              Sharpness sharpness = Sharpness::trace, const FramePart* frame = nullptr);

}  // namespace skerry
