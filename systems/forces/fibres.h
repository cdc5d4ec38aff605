// Force element (part of a step that adds forces to nodes): fibres in tetrahedra, which resist stretch and contract
// with an active tension (docs/methods/elasticity.md 2.7).
#pragma once

#include <array>
#include <span>

#include "components/body_table.h"
#include "components/fibre_table.h"
#include "components/free_nodes.h"
#include "components/ghost_marks.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/forces/add_loads.h"

namespace skerry {

/// Law of a family of fibres (Holzapfel, Gasser, Ogden 2000; docs/methods/elasticity.md 2.7). F is the deformation
/// gradient, a the direction of the fibres in the rest shape, I_4 = |F a|^2 the squared stretch, and E =
/// max(I_4 - 1, 0). The energy density is
///     W = k_1/(2 k_2) (exp(k_2 E^2) - 1)
/// The active tension adds the nominal stress `tension` along the fibres.
struct FibreLaw {
    Real stiffness, exponent;  // k_1 [Pa], k_2
    // Below this stretch the active stress is reduced in proportion to the stretch. Otherwise the force would jump at a
    // stretch of zero, where the direction of the fibres is not defined.
    static constexpr Real least_stretch = 0.1;

    /// Energy per rest volume without the active part [J/m^3]. `square`: squared stretch.
    Real energy(Real square) const;
    /// Stress vectors if the direction a of the fibres is stretched to y = F a.
    FibrePull pull(const Vec3& y, Real tension) const;
    /// Upper bound of the eigenvalues of the derivative of FibrePull::whole by y, for all active tensions from 0 to
    /// `tension` [Pa].
    Real stiffness_bound(const Vec3& y, Real tension) const;
};

/// The columns of FibreTable, and the nodes on which the fibres act.
struct FibreInputs {
    std::span<const Index> fibre_body;
    std::span<const Real> stiffness, exponent;
    std::span<const Range> tetrahedra, tension_keys;
    std::span<const TimeKey> key;
    // by tetrahedron
    std::span<const std::array<Index, 4>> node;
    std::span<const std::array<Real, 4>> slope;
    std::span<const Real> volume;
    // BodyTable and NodeTable
    std::span<const Range> body_nodes, body_implicit;
    std::span<const Vec3> position, velocity;
    GhostMarks ghosts;

    static FibreInputs bind(const Binder& binder, const FibreTable& fibres, const BodyTable& bodies,
                            const NodeTable& nodes) {
        return {.fibre_body = binder.read(fibres.body),
                .stiffness = binder.read(fibres.stiffness),
                .exponent = binder.read(fibres.exponent),
                .tetrahedra = binder.read(fibres.tetrahedra),
                .tension_keys = binder.read(fibres.tension_keys),
                .key = binder.read(fibres.key),
                .node = binder.read(fibres.node),
                .slope = binder.read(fibres.slope),
                .volume = binder.read(fibres.volume),
                .body_nodes = binder.read(bodies.nodes),
                .body_implicit = binder.read(bodies.implicit),
                .position = binder.read(nodes.position),
                .velocity = binder.read(nodes.velocity),
                .ghosts = {binder.read(bodies.ghost)}};
    }

    std::size_t size() const { return fibre_body.size(); }
    FibreLaw law(std::size_t row) const { return {stiffness[row], exponent[row]}; }
    /// Row in NodeTable of corner `c` of tetrahedron `t`, which belongs to the family `row`.
    std::size_t node_of(std::size_t row, std::size_t t, std::size_t c) const {
        return static_cast<std::size_t>(body_nodes[static_cast<std::size_t>(fibre_body[row])].begin + node[t][c]);
    }
    /// Derivative along the fibres of a field with the value `value_of(n)` at node n. For positions it is F a, with the
    /// direction a of the fibres in the rest shape; for velocities it is the rate of F a.
    Vec3 along(std::size_t row, std::size_t t, auto&& value_of) const {
        const Vec3 first = value_of(node_of(row, t, 0));
        Vec3 sum = Vec3::Zero();
        for (std::size_t c = 1; c < 4; ++c) sum += slope[t][c] * (value_of(node_of(row, t, c)) - first);
        return sum;
    }
    /// Direction of the fibres in the present shape: F times the direction in the rest shape.
    Vec3 stretched(std::size_t row, std::size_t t) const {
        return along(row, t, [this](std::size_t n) -> const Vec3& { return position[n]; });
    }
};

/// Adds the forces of all fibres to `applied_force`, by node [N]. An active tension that changes over time acts with
/// its mean over the force interval of the step. Stresses are computed in parallel and written to `next`; the nodal
/// forces are summed sequentially. Returns false if there are no fibres; reports then count the stage as skipped.
bool add_fibre_forces(Executor& executor, const FibreInputs& fibres, const ForceIntervals& intervals,
                      std::span<FibrePull> next, std::span<Vec3> applied_force);

/// Marks the bodies of fibres whose active tension changes in the step of length `h` that starts at time `t`: these
/// bodies must not sleep. Returns false if no tension changes. `marked`: by row of BodyTable; may be empty.
bool mark_activated(const FibreInputs& fibres, Real t, Real h, std::span<std::uint8_t> marked);

struct FibreWorkInputs {
    std::span<const FibrePull> next;
    std::span<const Vec3> passive_before;  // FibrePull::passive of the last step [Pa]
    std::span<const Vec3> velocity_next;   // NodeTable [m/s]
    FreeNodes free;

    static FibreWorkInputs bind(const Binder& binder, const FibreTable& fibres, const NodeTable& nodes,
                                const BodyTable& bodies, const RigidBodyTable& rigid) {
        return {.next = binder.read(fibres.next),
                .passive_before = binder.read(fibres.passive),
                .velocity_next = binder.read(nodes.velocity_next),
                .free = FreeNodes::bind(binder, nodes, bodies, rigid)};
    }
};

/// Work of the passive stress of all fibres on the nodes in a step [J]. Formulas, `h` and `lag`: see measure_work.h.
Real measure_fibres(const FibreInputs& fibres, const FibreWorkInputs& step, Real h, Real lag);

/// Passive energy of all fibres at the present positions [J], plus a correction for velocities that are `lag` seconds
/// older than positions (see spring_energy).
Real fibre_energy(const FibreInputs& fibres, const FibreWorkInputs& last, Real lag);

/// Stores the passive stress of a committed step. Returns false if there are no fibres; reports then count the stage as
/// skipped.
bool keep_fibre_stress(std::span<const FibrePull> next, std::span<Vec3> passive);

}  // namespace skerry
