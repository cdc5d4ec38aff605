// Force element (part of a step that adds forces to nodes): pressure on the faces of cavities, which may contain a gas
// or a liquid (docs/methods/cavities.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/cavity_table.h"
#include "components/column.h"
#include "components/free_nodes.h"
#include "components/ghost_marks.h"
#include "components/handle.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "components/types.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

/// State of the filling of a cavity.
struct CavityFilling {
    CavityLaw law;
    CavityFluid fluid;
    // Mass of the gas [kg], volume of the liquid at ambient pressure [m^3] or prescribed pressure [Pa].
    Real amount;
    Real volume;  // [m^3]

    /// Pressure above ambient pressure [Pa]; NaN if the volume of a gas or a liquid is not positive.
    Real pressure() const;
    /// Derivative of the pressure by the mass, for a gas only [Pa/kg].
    Real pressure_per_mass() const;
    /// Work that the filling and the ambient pressure would do on the faces until the pressures inside and outside are
    /// equal [J]; 0 for a prescribed pressure.
    Real energy() const;
};

struct CavityInputs {
    std::span<const CavityLaw> law;
    std::span<const Index> body;
    std::span<const std::uint8_t> closed;
    std::span<const Range> faces;
    std::span<const std::array<Index, 3>> face;
    std::span<const Mat3> corners;
    std::span<const Range> keys;
    std::span<const TimeKey> key;
    std::span<const CavityFluid> fluid;
    std::span<const Real> mass;         // mass of the gas [kg]
    std::span<const Real> open_volume;  // CavityTable::volume [m^3]
    std::span<const Range> body_nodes;  // BodyTable
    std::span<const Vec3> position;     // by node [m]

    static CavityInputs bind(const Binder& binder, const CavityTable& cavity, const BodyTable& body,
                             const NodeTable& node) {
        return {.law = binder.read(cavity.law),
                .body = binder.read(cavity.body),
                .closed = binder.read(cavity.closed),
                .faces = binder.read(cavity.faces),
                .face = binder.read(cavity.face),
                .corners = binder.read(cavity.corners),
                .keys = binder.read(cavity.keys),
                .key = binder.read(cavity.key),
                .fluid = binder.read(cavity.fluid),
                .mass = binder.read(cavity.mass),
                .open_volume = binder.read(cavity.volume),
                .body_nodes = binder.read(body.nodes),
                .position = binder.read(node.position)};
    }

    std::size_t size() const { return law.size(); }
    std::span<const TimeKey> keys_of(std::size_t c) const { return rows_of(key, keys[c]); }
    /// Present positions of the corners of a face of cavity `c`, as columns [m].
    Mat3 corners_now(std::size_t c, std::size_t f) const;
    /// Contribution of face `f` to the volume of cavity `c` [m^3]. In a closed cavity: signed volume of the tetrahedron
    /// that connects the face with the first corner of the cavity's first face. In an open cavity: volume that the face
    /// has swept since it was at `corners`.
    Real volume_part(std::size_t c, std::size_t f) const;
    /// Present volume of cavity `c` [m^3].
    Real volume(std::size_t c) const;
    /// Filling of cavity `c` at time `t` [s], if the cavity has this volume [m^3].
    CavityFilling filling(std::size_t c, Real t, Real volume) const;
};

/// Area vector of a triangle, which is its area times its normal [m^2]. `corners`: positions as columns [m].
Vec3 area_of(const Mat3& corners);
/// Length of the longest edge of a triangle [m].
Real longest_edge(const Mat3& corners);

/// Stiffness -dp/dV of a filling [Pa/m^3]; 0 for a prescribed pressure. For a boiling liquid, whose pressure is
/// constant, the result is only an upper bound: the stiffness before boiling. `pressure`: above ambient [Pa].
Real filling_stiffness(CavityLaw law, const CavityFluid& fluid, Real pressure, Real volume);
/// Mass of a gas at a pressure above ambient [kg].
Real mass_of_gas(const CavityFluid& fluid, Real pressure, Real volume);

struct CavityOutputs {
    Column<Vec3>& area;
    Column<Real>& swept_parts;
    std::span<Real> volume_now;
    std::span<Vec3> applied_force;  // by node [N]

    static CavityOutputs bind(const Binder& binder, CavityTable& cavity, NodeTable& node) {
        return {.area = binder.make(cavity.area),
                .swept_parts = binder.make(cavity.swept_parts),
                .volume_now = binder.write(cavity.volume_now),
                .applied_force = binder.write(node.applied_force)};
    }
};

/// Adds the forces of the pressure in all cavities to the applied forces of nodes. Each corner of a face receives a
/// third of pressure times area, in the direction into the body. Returns false if there is no cavity.
/// - `now`: time of the positions [s]. A liquid at ambient pressure has its prescribed volume at this time.
/// - `kick`: time for which the forces act, beginning `lag` before `now` [s]. A prescribed pressure acts with its mean
///   over this time.
bool add_cavity_forces(Executor& executor, const CavityInputs& cavities, Real now, Real lag, Real kick,
                       const CavityOutputs& out);

struct CavityWorkInputs {
    std::span<const Vec3> area;                     // CavityTable [m^2]
    std::span<const Real> volume_now, power;        // CavityTable [m^3], [W]
    std::span<const Vec3> velocity, velocity_next;  // NodeTable [m/s]
    FreeNodes free;
    GhostMarks ghosts;  // cavities of ghosts have no energy on this rank

    static CavityWorkInputs bind(const Binder& binder, const CavityTable& cavity, const NodeTable& node,
                                 const BodyTable& body, const RigidBodyTable& rigid) {
        return {.area = binder.read(cavity.area),
                .volume_now = binder.read(cavity.volume_now),
                .power = binder.read(cavity.power),
                .velocity = binder.read(node.velocity),
                .velocity_next = binder.read(node.velocity_next),
                .free = FreeNodes::bind(binder, node, body, rigid),
                .ghosts = {binder.read(body.ghost)}};
    }
};

struct PipeInputs {
    std::span<const Index> first_body, second_body;
    std::span<const std::uint32_t> first, second;
    std::span<const Real> conductance;
    std::span<const Range> keys;
    std::span<const TimeKey> key;

    static PipeInputs bind(const Binder& binder, const PipeTable& pipe) {
        return {.first_body = binder.read(pipe.first_body),
                .second_body = binder.read(pipe.second_body),
                .first = binder.read(pipe.first),
                .second = binder.read(pipe.second),
                .conductance = binder.read(pipe.conductance),
                .keys = binder.read(pipe.keys),
                .key = binder.read(pipe.key)};
    }

    std::size_t size() const { return first.size(); }
    std::span<const TimeKey> keys_of(std::size_t p) const { return rows_of(key, keys[p]); }
};

struct CavityMemory {
    std::span<Real> mass, volume, pressure_now, power;
    std::span<Mat3> corners;
    std::span<Real> flow;  // PipeTable

    static CavityMemory bind(const Binder& binder, CavityTable& cavity, PipeTable& pipe) {
        return {.mass = binder.write(cavity.mass),
                .volume = binder.write(cavity.volume),
                .pressure_now = binder.write(cavity.pressure_now),
                .power = binder.write(cavity.power),
                .corners = binder.write(cavity.corners),
                .flow = binder.write(pipe.flow)};
    }
};

/// Ends a step of length `h` that began at time `t`:
/// - stores the pressures at time `t`
/// - adds the prescribed flow of gas to the masses in cavities; an outflow ends when a cavity contains no more gas
/// - lets gas flow through the pipes in table order
/// - updates the volumes of open cavities
///
/// Returns the energy that changes of the amounts of gas and liquid have added to the fillings [J].
Real store_cavities(const CavityInputs& cavities, const PipeInputs& pipes, const HandleMap<CavityHandle>& cavity_map,
                    const CavityWorkInputs& step, Real t, Real h, const CavityMemory& out);

/// Work of gases and liquids on the nodes in a step that begins at time `t` [J]. Formulas, `h` and `lag`: see
/// measure_work.h.
Real measure_cavities(const CavityInputs& cavities, const CavityWorkInputs& step, Real t, Real h, Real lag);

/// Energy of all gases and liquids at the present positions and time `t` [J], plus a correction for velocities that are
/// `lag` seconds older than positions, as in spring_energy.
Real cavity_energy(const CavityInputs& cavities, const CavityWorkInputs& last, Real t, Real lag);

/// Marks the bodies of cavities that must not sleep: those whose prescribed values change from `t` to `t + h`, or whose
/// mass of gas changes. In a pipe, gas counts as flowing if the absolute pressures at both ends differ by more than
/// 1e-9 of their sum. Returns false if there is no such body.
///
/// `marked`: by row of BodyTable; if it is empty, only the return value is computed.
bool mark_filled(const CavityInputs& cavities, const PipeInputs& pipes, const HandleMap<CavityHandle>& cavity_map,
                 Real t, Real h, std::span<std::uint8_t> marked);

}  // namespace skerry
