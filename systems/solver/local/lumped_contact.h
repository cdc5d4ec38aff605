// One contact between nodes with lumped masses. Its diagonal block of the Delassus operator W is a scalar times the
// identity (docs/methods/contact.md 2.1). A contact step gathers node velocities, projects the impulse, and scatters
// its change to the nodes.
#pragma once

#include <array>

#include "components/options.h"
#include "components/types.h"
#include "systems/solver/local/friction_law.h"

namespace skerry {

/// Data of one contact for a sweep, stored contiguously. Nodes that do not move are omitted; `offset` contains their
/// velocity.
struct LumpedContact {
    Vec4 normal;  // unit vector
    Vec4 offset;  // velocity of fixed nodes - surface velocity + bias along the normal - midpoint_slip [m/s]
    std::array<Real, 4> weight;  // stencil weights of the moving nodes
    std::array<Real, 4> step;    // weight times inverse mass of each moving node [1/kg]
    std::array<Index, 4> node;   // velocity rows of the moving nodes in the region
    Index node_count;            // number of moving nodes; 0 if the contact moves only rigid bodies or nothing
    Real diagonal;               // mobility D: a third of the trace of the diagonal block W_ii [1/kg]
    Real inverse_diagonal;       // 1/D; 0 if no impulse of this contact can move anything [kg]
    Real bias;                   // normal bias b_n of docs/methods/contact.md 3.1, included in `offset` [m/s]
    FrictionLimits friction;
};

/// Returns `start` plus the weighted sum of the velocities of the moving nodes.
[[gnu::always_inline]] inline Vec4 add_node_velocities(const LumpedContact& contact, const Vec4* velocity, Vec4 start) {
    for (Index a = 0; a < contact.node_count; ++a) start += contact.weight[a] * velocity[contact.node[a]];
    return start;
}

/// Velocity u = W r + q of one contact, from the present node velocities [m/s]
inline Vec4 contact_velocity(const LumpedContact& contact, const Vec4* velocity) {
    return add_node_velocities(contact, velocity, contact.offset);
}

inline void apply_impulse(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) {
    for (Index a = 0; a < contact.node_count; ++a) velocity[contact.node[a]] += contact.step[a] * impulse;
}

/// Scalar c, where the block of W for contacts a and b is c times the identity [1/kg]
inline Real coupling_of(const LumpedContact& a, const LumpedContact& b) {
    Real coupling = 0;
    for (Index k = 0; k < a.node_count; ++k)
        for (Index l = 0; l < b.node_count; ++l)
            if (a.node[k] == b.node[l]) coupling += a.weight[k] * b.step[l];
    return coupling;
}

/// Gauss-Seidel step of one contact (docs/methods/friction.md 2.2). `apply` changes the node velocities by an impulse.
/// Returns D |change of the impulse|^2 with the mobility D (LumpedContact::diagonal) [J]
template <class Apply>
inline Real solve_contact(const LumpedContact& contact, Friction friction, Real relaxation, Vec4* velocity,
                          Vec4& impulse, const Apply& apply) {
    const Vec4 u = contact_velocity(contact, velocity);
    const Vec4 stopping = impulse - (relaxation * contact.inverse_diagonal) * u;
    const Vec4 next = project_friction(stopping, contact.normal, contact.friction, friction);
    const Vec4 change = next - impulse;
    const Real size = change.dot(change);
    if (size == 0) return 0;  // the impulse is unchanged, as for most open contacts
    apply(contact, change, velocity);
    impulse = next;
    return contact.diagonal * size;
}
inline Real solve_contact(const LumpedContact& contact, Friction friction, Real relaxation, Vec4* velocity,
                          Vec4& impulse) {
    return solve_contact(
        contact, friction, relaxation, velocity, impulse,
        [](const LumpedContact& of, const Vec4& change, Vec4* moved) { apply_impulse(of, change, moved); });
}

/// Residual of the friction law at the velocity u: the impulse minus the impulse that the law gives (natural map F_i of
/// docs/methods/errors.md 1). Uses the De Saxce form for a cone with equal static and dynamic coefficients, otherwise
/// the residual of the contact step. gnu::flatten: see project_onto_cone.
[[gnu::flatten]] inline Vec4 natural_map(const LumpedContact& contact, Friction friction, const Vec4& impulse,
                                         const Vec4& u) {
    const FrictionLimits mu = contact.friction;
    if (friction == Friction::cone && mu.stick == mu.slide && !mu.ties()) {
        const Vec4 tangential = u - contact.normal.dot(u) * contact.normal;
        const Vec4 shifted = u + (mu.stick * tangential.norm()) * contact.normal;
        return impulse -
               project_onto_cone(Vec4(impulse - contact.inverse_diagonal * shifted), contact.normal, mu.stick);
    }
    return impulse - project_friction(Vec4(impulse - contact.inverse_diagonal * u), contact.normal, mu, friction);
}

/// True if a contact with velocity u opens, so that it needs no impulse. Ties do not open.
inline bool separates(const LumpedContact& contact, const Vec4& u) {
    return contact.normal.dot(u) >= 0 && !contact.friction.ties();
}

}  // namespace skerry
