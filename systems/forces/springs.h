// Force element (part of a step that adds forces to nodes): springs and dampers between anchors
// (docs/methods/springs.md).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/free_nodes.h"
#include "components/ghost_marks.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "components/spring_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"
#include "systems/forces/anchors.h"

namespace skerry {

/// Law of one spring.
struct SpringLaw {
    SpringSide side;
    Real stiffness, damping, strength;  // [N/m], [N s/m], [N]

    /// True if spring and damper act at this extension. `extension`: length minus rest length [m].
    bool acts(Real extension) const {
        return side == SpringSide::both || (side == SpringSide::tension ? extension > 0 : extension < 0);
    }
    /// Elastic tension [N].
    Real tension(Real extension) const;
    /// Elastic energy, whose derivative is the elastic tension [J].
    Real energy(Real extension) const;
    /// Tension of spring and damper together [N]. Its magnitude is at most `strength`. If the spring is one-sided, it
    /// only pulls or only pushes. `elastic`: elastic tension [N]; `damper`: force of the damper alone [N].
    Real with_damper(Real extension, Real elastic, Real damper) const;
};

struct SpringInputs {
    AnchorInputs first, second;
    std::span<const SpringSide> side;
    std::span<const Real> stiffness, damping, strength;
    std::span<const Range> rest_length;
    std::span<const TimeKey> key;
    std::span<const std::uint8_t> body_asleep;  // column of BodyTable; empty if no body is asleep
    GhostMarks ghosts;

    static SpringInputs bind(const Binder& binder, const SpringTable& springs, const BodyTable& bodies,
                             const NodeTable& nodes, const ColliderTable& colliders, const bool& any_asleep) {
        return {.first = AnchorInputs::bind(binder, springs.first, bodies, nodes, colliders),
                .second = AnchorInputs::bind(binder, springs.second, bodies, nodes, colliders),
                .side = binder.read(springs.side),
                .stiffness = binder.read(springs.stiffness),
                .damping = binder.read(springs.damping),
                .strength = binder.read(springs.strength),
                .rest_length = binder.read(springs.rest_length),
                .key = binder.read(springs.key),
                .body_asleep = binder.read_if(binder.value(any_asleep), bodies.asleep),
                .ghosts = {binder.read(bodies.ghost)}};
    }

    std::size_t size() const { return side.size(); }
    /// True if a body of the spring is a ghost: another rank then counts the work and energy of the spring.
    bool is_ghost(std::size_t s) const { return ghosts.contain(first.body[s]) || ghosts.contain(second.body[s]); }
    SpringLaw law(std::size_t s) const { return {side[s], stiffness[s], damping[s], strength[s]}; }
    Real rest(std::size_t s, Real t) const { return value_at(rows_of(key, rest_length[s]), t); }
    /// True if every body of the spring is asleep.
    bool rests(std::size_t s) const {
        if (body_asleep.empty()) return false;
        const auto sleeps = [&](Index body) {
            return body == no_index || body_asleep[static_cast<std::size_t>(body)] != 0;
        };
        return sleeps(first.body[s]) && sleeps(second.body[s]);
    }
    /// True if the rest length changes in the step of length `h` that starts at time `t`, or a collider of the spring
    /// moves in this step.
    bool is_driven(std::size_t s, Real t, Real h) const;
};

/// Inverse masses of the anchors of springs.
struct SpringMasses {
    std::span<const AnchorMass> first, second;
    std::span<const Mat3> first_response, second_response;  // columns of SpringTable [1/kg]
    // BodyTable and RigidBodyTable:
    std::span<const Range> body_rigid;
    std::span<const Real> mass;
    std::span<const Vec3> center, moments;
    std::span<const Mat3> rotation;
    std::span<const Index> holder;

    static SpringMasses bind(const Binder& binder, const SpringTable& springs, const BodyTable& bodies,
                             const RigidBodyTable& rigid) {
        return {.first = binder.read(springs.first_mass),
                .second = binder.read(springs.second_mass),
                .first_response = binder.read(springs.first_response),
                .second_response = binder.read(springs.second_response),
                .body_rigid = binder.read(bodies.rigid),
                .mass = binder.read(rigid.mass),
                .center = binder.read(rigid.center),
                .moments = binder.read(rigid.moments),
                .rotation = binder.read(rigid.rotation),
                .holder = binder.read(rigid.holder)};
    }
};

/// Adds the forces of all springs to `applied_force`, by node [N]. `t`: time at the start of the step [s]; `h`: step
/// length [s]; `kick`: time for which the forces act [s]. Spring forces are computed in parallel and written to `next`,
/// and are summed sequentially. Returns false if there is no spring; reports then count the stage as skipped.
bool add_spring_forces(Executor& executor, const SpringInputs& springs, const SpringMasses& masses, Real t, Real h,
                       Real kick, std::span<SpringForce> next, std::span<Vec3> applied_force);

/// Marks the bodies of driven springs (SpringInputs::is_driven), which must not sleep. Returns false if no spring is
/// driven. `marked`: by row of BodyTable.
bool mark_driven_bodies(const SpringInputs& springs, Real t, Real h, std::span<std::uint8_t> marked);

/// Energies of all springs in a step.
struct SpringWork {
    // Work of the springs on the anchors, minus the work that changes of the rest lengths do on the springs [J].
    // Without dampers this difference equals the decrease of the elastic energy.
    Real work = 0;
    Real dissipated = 0;  // energy dissipated by dampers [J]
};

struct SpringWorkInputs {
    std::span<const SpringForce> next;
    std::span<const Vec3> force_before;      // forces in the last step [N]
    std::span<const Real> elastic_before;    // elastic tension [N]
    std::span<const Real> rest_rate_before;  // [m/s]
    std::span<const Vec3> velocity_next;     // NodeTable [m/s]
    FreeNodes free;

    static SpringWorkInputs bind(const Binder& binder, const SpringTable& springs, const NodeTable& nodes,
                                 const BodyTable& bodies, const RigidBodyTable& rigid) {
        return {.next = binder.read(springs.next),
                .force_before = binder.read(springs.force),
                .elastic_before = binder.read(springs.elastic),
                .rest_rate_before = binder.read(springs.rest_rate),
                .velocity_next = binder.read(nodes.velocity_next),
                .free = FreeNodes::bind(binder, nodes, bodies, rigid)};
    }
};

/// Measures the work of springs. Formulas, `h`, `kick` and `lag`: see measure_work.h.
SpringWork measure_springs(const SpringInputs& springs, const SpringWorkInputs& step, Real h, Real kick, Real lag);

/// Elastic energy of all springs at the present positions and the present time `t` [s], plus a correction [J].
///
/// The correction is due to velocities that are `lag` seconds older than positions. The energy balance adds `lag` times
/// the power of all forces to the kinetic energy, with the spring forces of the last step. The correction replaces
/// these by the present elastic forces: it is `lag` times the power of the difference, on the anchors and by changes of
/// rest lengths.
Real spring_energy(const SpringInputs& springs, const SpringWorkInputs& last, Real t, Real lag);

struct SpringMemory {
    std::span<Vec3> force;
    std::span<Real> tension, elastic, rest_rate;

    static SpringMemory bind(const Binder& binder, SpringTable& springs) {
        return {.force = binder.write(springs.force),
                .tension = binder.write(springs.tension),
                .elastic = binder.write(springs.elastic),
                .rest_rate = binder.write(springs.rest_rate)};
    }
};

/// Stores the forces of a committed step. Returns false if there is no spring; reports then count the stage as skipped.
bool keep_spring_forces(std::span<const SpringForce> next, const SpringMemory& out);

}  // namespace skerry
