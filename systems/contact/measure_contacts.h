// Measures each contact after the solve: its slip velocity, and whether it sticks or slides.
#pragma once

#include "components/contact_table.h"
#include "components/options.h"
#include "jobs/executor.h"
#include "systems/contact/node_groups.h"

namespace skerry {

struct ContactMeasures {
    Real max_penetration = 0;    // greatest overlap of two surfaces: -distance [m]
    Real max_gap_violation = 0;  // greatest amount by which a distance is below the contact distance: -gap [m]
    // Dissipated energy: -sum of impulse . (v_before + v_after) / 2, where v_before and v_after are the relative
    // velocities at a contact before and after the solve [J].
    Real dissipated = 0;
    // Impulse and work that the moving nodes get from colliders and held nodes. The momentum of the moving nodes grows
    // by outer_impulse, their energy by outer_work - dissipated.
    Vec3 outer_impulse = Vec3::Zero();  // [N s]
    Real outer_work = 0;                // [J]
    Index stick_count = 0;
    Index slide_count = 0;
};

/// Spins (angular velocities) of round bodies before and after the solve. The surface of a round body moves at the
/// velocity of its core nodes (centre or axis) plus a part due to the spin.
struct RoundSpins {
    RigidNodes nodes{};
    RigidSpins spins{};
    std::span<const Vec3> contact_moment{};  // RigidBodyTable

    static RoundSpins bind(const Binder& binder, const NodeTable& node, const BodyTable& body,
                           const RigidBodyTable& rigid) {
        return {.nodes = RigidNodes::bind(binder, node, body, rigid),
                .spins = RigidSpins::bind(binder, rigid),
                .contact_moment = binder.read(rigid.contact_moment)};
    }

    Vec3 before(std::size_t r) const { return spins.before(r); }
    Vec3 after(std::size_t r) const {
        return spins.inverse_inertia[r] * (spins.angular_momentum[r] + spins.moment_kick[r] + contact_moment[r]);
    }
};

/// Writes `slip`, the tangential relative velocity after the solve, and `state` (open: no impulse; slide: impulse on
/// the limit of `friction`; stick: impulse below the limit). Parallel over blocks of contacts; sums are added in block
/// order.
ContactMeasures measure_contacts(Executor& executor, const ContactTable& contacts, std::span<const Real> inverse_mass,
                                 std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
                                 const RoundSpins& spins, std::span<Vec3> slip, std::span<ContactState> state,
                                 Friction friction = Friction::cone);

}  // namespace skerry
