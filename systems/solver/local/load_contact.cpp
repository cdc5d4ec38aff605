#include "systems/solver/local/load_contact.h"

#include <algorithm>
#include <cmath>

namespace skerry {
namespace {

/// Contact velocity before and after the forces of the step [m/s]. `now` is predicted, without contact impulses. It
/// leaves out the velocity change by the deformation of implicit bodies, because contact impulses cancel this change in
/// a body at rest.
struct KickVelocities {
    Vec3 before, now;
};

inline KickVelocities kick_velocities(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next) {
    const Stencil& stencil = inputs.stencil[row];
    KickVelocities velocity{-inputs.surface_velocity[row], -inputs.surface_velocity[row]};
    for (std::size_t a = 0; a < 4; ++a) {
        if (stencil.weight[a] == 0) continue;
        velocity.before += stencil.weight[a] * inputs.velocity[stencil.node[a]];
        velocity.now += stencil.weight[a] * velocity_next[stencil.node[a]];
    }
    const Vec3& normal = inputs.normal[row];
    const RigidInputs& rigid = inputs.rigid;
    const auto contact = static_cast<std::size_t>(row);
    velocity.before += rigid.nodes.rolling(stencil, contact, normal, inputs.touch,
                                           [&](std::size_t r) { return rigid.spins.before(r); });
    velocity.now += rigid.nodes.rolling(stencil, contact, normal, inputs.touch,
                                        [&](std::size_t r) { return rigid.spins.kicked(r); });
    if (inputs.implicit.any())
        for (std::size_t a = 0; a < 4; ++a)
            if (stencil.weight[a] != 0)
                velocity.now -=
                    stencil.weight[a] * inputs.implicit.deformation_kick(stencil.node[a], inputs.rigid.nodes);
    return velocity;
}

}  // namespace

Real contact_bias(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next,
                  const SolverSettings& settings, Real h) {
    const Real gap = inputs.gap[row];
    const Real closing = gap < 0 ? 0 : gap / h;
    const Real restitution = inputs.restitution[row];
    if (restitution == 0) return closing;
    const auto [before, coming] = kick_velocities(inputs, row, velocity_next);
    const Real approach = before.dot(inputs.normal[row]);
    // A contact is an impact only if its approach speed clearly exceeds the velocity change by the forces of one step
    // (docs/methods/contact.md 3.2). Otherwise a node at rest would bounce forever, because weight and elastic forces
    // press on it in every step.
    const Real kick_speed = std::abs(coming.dot(inputs.normal[row]) - approach);
    constexpr Real clearly = 2;  // least ratio of the approach speed of an impact to the velocity change by forces
    const Real slowest_impact =
        std::max({settings.restitution_speed, clearly * inputs.gravity * h, clearly * kick_speed});
    const bool impact = approach < -slowest_impact && gap + h * approach <= 0;
    return impact ? std::min(closing, restitution * approach) : closing;
}

Vec3 midpoint_slip(const RegionInputs& inputs, Index row, std::span<const Vec3> velocity_next) {
    if (inputs.dynamic_friction[row] == 0 || inputs.is_tie(row)) return Vec3::Zero();
    if (!inputs.friction_axis.empty() && inputs.friction_axis[row].across != 1) return Vec3::Zero();
    const auto [before, now] = kick_velocities(inputs, row, velocity_next);
    const Vec3& normal = inputs.normal[row];
    const Vec3 slip_before = before - normal.dot(before) * normal, slip = now - normal.dot(now) * normal,
               turn = slip - slip_before;
    // `fading` is 1 if the forces change the slip by at most a quarter of the sliding speed, and 0 if by at least a
    // half. It keeps the correction continuous: if forces nearly stop or reverse the sliding, no direction at the
    // middle of the step is defined.
    constexpr Real fade_end = 2, slope = 4;
    const Real fading = fade_end - slope * turn.norm() / slip_before.norm();
    if (!(fading > 0) || turn.isZero(0)) return Vec3::Zero();
    return 0.5 * std::min(Real(1), fading) * (turn - (slip.dot(turn) / slip.squaredNorm()) * slip);
}

}  // namespace skerry
