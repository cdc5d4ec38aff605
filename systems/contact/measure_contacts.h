// Measures each contact after the solve: its slip velocity, and whether it sticks or slides.
#pragma once

#include "components/contact_table.h"
#include "components/options.h"
#include "jobs/executor.h"
#include "systems/contact/node_groups.h"

namespace skerry {

struct ContactMeasures {
    Real max_penetration = 0;    // greatest penetration: overlap of the surfaces, -distance [m]
    Real max_gap_violation = 0;  // greatest depth inside the contact distance, -gap [m]
    // Dissipated energy: -sum of impulse . (relative velocity before + relative velocity after the solve) / 2 [J].
    Real dissipated = 0;
    // Impulse and work that the moving nodes get from colliders and held nodes. Their momentum grows by outer_impulse,
    // their energy by outer_work - dissipated.
    Vec3 outer_impulse = Vec3::Zero();  // [N s]
    Real outer_work = 0;                // [J]
    Index stick_count = 0;
    Index slide_count = 0;
};

/// Spins of round bodies before and after the solve. Spin adds to the velocity of the surface at a contact; the
/// velocity of the core nodes does not contain it.
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
