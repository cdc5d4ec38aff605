// A rigorous bound on the highest frequency of one tetrahedron in its present shape, element_lanes side by side
// (docs/methods/stable_step.md 3, 4).
#pragma once

#include "components/material_table.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/lane_math.h"
#include "systems/material/relaxation.h"

namespace skerry {

/// What stiffens an element beside its law; moduli of zero: nothing.
struct ViscousPart {
    ViscousModuli moduli{};
    ViscousStretch<Real8> stretch{};
    Real8 strain_share = Real8{} + 1.0, volume_share = Real8{} + 1.0;  // of the moduli that count
};

/// What an element has of the mass by b (R:X)^2 of the gradient X of displacements, beside that of Q (frame_masses.h).
struct FramePart {
    Mat3 rotation = Mat3::Identity();
    Real8 b{};  // kg m^2
};

/// lambda_max(M^-1/2 K M^-1/2) of each element from above, 1/s^2. K = V G^T H G with
/// the rest gradients G and H = dP/dF at F, M the corners' shares of mass; `Q` = sum over the corners of g_a g_a^T /
/// m_a; with `frame` they have that mass, too. `q` starts the frame of an element whose law has one and is left at the
/// frame found. Lanes without volume get 0. Where all eight are below `enough` (1/s^2) they get that, in a tenth of the
/// time.
enum class Sharpness {
    trace,     // at most 15 % too large
    bisected,  // at most 0.3 %, in twice the time
    compared,  // infinity where not all eight are below `enough`
    stepped    // at most a tenth, in steps of a tenth from `enough` on; infinity beyond ten times that
};
Real8 frequency_squared_bound(const MaterialConstants& material, const LaneMat3<Real8>& F, const ViscousPart& viscous,
                              const Real8& volume, const LaneMat3<Real8>& Q, LaneQuaternion<Real8>& q, Real enough = 0,
                              Sharpness sharpness = Sharpness::trace, const FramePart* frame = nullptr);

}  // namespace skerry
