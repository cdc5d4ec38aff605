// Prepares the cables of a step: geometry, control and friction. Adds the forces that are known before the solve, and
// stores the results (docs/methods/cables.md).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/cable_table.h"
#include "components/collider_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "systems/forces/anchors.h"

namespace skerry {

struct CableInputs {
    std::span<const CableControl> control;
    std::span<const Real> friction, released, step;
    std::span<const Range> points, keys;
    std::span<const Real> tension, length;  // by point
    std::span<const TimeKey> key;
    AnchorInputs anchor;
    std::span<const Real> inverse_mass;         // by node [1/kg]
    std::span<const std::uint8_t> body_asleep;  // column of BodyTable; empty if no body is asleep

    static CableInputs bind(const Binder& binder, const CableTable& cable, const BodyTable& body, const NodeTable& node,
                            const ColliderTable& collider, const bool& any_asleep) {
        return {.control = binder.read(cable.control),
                .friction = binder.read(cable.friction),
                .released = binder.read(cable.released),
                .step = binder.read(cable.step),
                .points = binder.read(cable.points),
                .keys = binder.read(cable.keys),
                .tension = binder.read(cable.tension),
                .length = binder.read(cable.length),
                .key = binder.read(cable.key),
                .anchor = AnchorInputs::bind(binder, cable.anchor, body, node, collider),
                .inverse_mass = binder.read(node.inverse_mass),
                .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep)};
    }

    std::size_t size() const { return control.size(); }
    std::span<const TimeKey> keys_of(std::size_t cable) const { return rows_of(key, keys[cable]); }
    /// True if the forces of the cable are known before the step: its tension is prescribed, and it has no friction.
    bool has_known_forces(std::size_t cable) const {
        return control[cable] == CableControl::tension && friction[cable] == 0;
    }
    /// True if at least one point of the cable is on a collider that moves in this step.
    bool is_led(std::size_t cable) const;
    /// True if the prescribed value of the cable changes, or a collider moves one of its points, in the step of length
    /// `h` that starts at time `t`. A nonzero prescribed rate of length also counts.
    bool is_driven(std::size_t cable, Real t, Real h) const;
    /// True if no point of the cable moves in this step: all its bodies are asleep, and no collider moves a point.
    /// Always false if no body of the world is asleep.
    bool rests(std::size_t cable) const;
    /// True if impulses of the cable can move a node of a body.
    bool moves(std::size_t cable) const;
};

/// Times of a step, and the recovery speed of the cables. `t`: start of the step [s]. `h`: its length [s]. `kick`: time
/// for which forces act in the step [s].
struct CableTimes {
    Real t = 0, h = 0, kick = 0;
    Real recovery_speed = 0;  // upper limit of the speed at which a too long cable is shortened [m/s]

    static CableTimes bind(const Binder& binder, const Real& t, const Real& h, const Real& kick,
                           const Real& recovery_speed) {
        return {binder.value(t), binder.value(h), binder.value(kick), binder.value(recovery_speed)};
    }
};

/// Lists the cables that act in this step. The cables with known forces (CableInputs::has_known_forces) come first; the
/// region solver finds the forces of the others. Returns false if there is no cable.
bool prepare_cables(const CableInputs& cables, const CableTimes& times, CableBlockTable& blocks);

/// Adds the forces of the cables with known forces to `applied_force`, by node [N]. `kick`: time for which the impulses
/// in `blocks` act [s]. Returns false if there is no such cable.
bool add_cable_forces(const CableBlockTable& blocks, Real kick, std::span<Vec3> applied_force);

/// Adds to `body_rates`, by row of BodyTable, an upper bound of the squared circular frequencies that cables cause in
/// the body [1/s^2]. The stable step depends on it. A prescribed tension counts with its greatest value, any other
/// tension with its value in the last step.
void add_cable_rates(const CableInputs& cables, std::span<Real> body_rates);

/// Marks the bodies of driven cables (CableInputs::is_driven), which must not sleep. Returns false if no cable is
/// driven. `marked`: by row of BodyTable.
bool mark_driven_cables(const CableInputs& cables, Real t, Real h, std::span<std::uint8_t> marked);

/// Work and loss of a cable during a motion.
struct CableWork {
    Real work = 0;        // work that the prescribed tension or length does on the cable [J]
    Real dissipated = 0;  // energy that friction at the points dissipates [J]
};
/// Returns the work and loss of a cable whose segments change their lengths from `before` to `now` [m]. `tension`: by
/// segment [N]. It may contain impulses of tensions [N s] instead; the results are then energies times the duration of
/// the impulses [J s].
CableWork work_of_cable(std::span<const Real> tension, std::span<const Real> before, std::span<const Real> now);

/// Columns of CableTable that a committed step stores for the next step.
struct CableMemory {
    std::span<const CableControl> control;
    std::span<const Range> points, keys;
    std::span<const TimeKey> key;
    std::span<Real> released, step, work, dissipated, tension, length;

    static CableMemory bind(const Binder& binder, CableTable& cable) {
        return {.control = binder.read(cable.control),
                .points = binder.read(cable.points),
                .keys = binder.read(cable.keys),
                .key = binder.read(cable.key),
                .released = binder.write(cable.released),
                .step = binder.write(cable.step),
                .work = binder.write(cable.work),
                .dissipated = binder.write(cable.dissipated),
                .tension = binder.write(cable.tension),
                .length = binder.write(cable.length)};
    }
};

/// Stores the tensions and lengths of the cables that act, and advances the greatest permitted length of all cables
/// with a prescribed rate. Also adds the work of the acting cables in the previous step, because the lengths at its end
/// are known only now. Returns false if there is no cable.
bool store_cables(const CableBlockTable& blocks, const CableTimes& times, const CableMemory& out);

/// Totals over the cables that the region solver has solved in a step. Cables on ghosts (copies of bodies that another
/// rank owns) do not count, because the owner counts them.
struct CableMeasures {
    Vec3 impulse = Vec3::Zero();  // impulse that cables transmit from colliders and from held nodes [N s]
    Real work = 0;                // work of the cables on the bodies [J]
    Real dissipated = 0;          // energy that friction at the points dissipates [J]
};
CableMeasures measure_cables(const CableBlockTable& blocks, std::span<const Index> node_body,
                             std::span<const GhostKind> body_ghost);

}  // namespace skerry
