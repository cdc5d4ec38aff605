// Force element (part of a step that adds forces to nodes): loads on nodes and faces, and force fields, with scales
// that change over time (docs/methods/loads.md).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/column.h"
#include "components/load_table.h"
#include "components/node_table.h"
#include "components/types.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

/// Time intervals in which forces act in a step. The intervals of successive steps join without gaps.
struct ForceIntervals {
    Real begin = 0, length = 0;                    // for explicit and rigid bodies [s]
    Real begin_implicit = 0, length_implicit = 0;  // for implicit bodies [s]
};

/// Sum of all force fields that act on a body. The force on a node of mass m and velocity v is m (acceleration - drag
/// v).
struct BodyField {
    Vec3 acceleration = Vec3::Zero();  // [m/s^2]
    Real drag = 0;                     // [1/s]
};

/// The columns of LoadTable, and those of the bodies and nodes that the loads act on.
struct LoadInputs {
    std::span<const LoadKind> kind;
    std::span<const Index> load_body;
    std::span<const Vec3> vector;
    std::span<const Real> rate;
    std::span<const LoadArea> area;
    std::span<const Range> load_nodes, scale_keys;
    std::span<const Index> share_node;
    std::span<const Real> weight;
    std::span<const TimeKey> key;
    // Columns of BodyTable and NodeTable:
    std::span<const BodyKind> body_kind;
    std::span<const Range> body_nodes, body_implicit;
    std::span<const Index> node_body;
    std::span<const Real> mass;                // [kg]
    std::span<const Vec3> position, velocity;  // state at the start of the step [m, m/s]
    Vec3 gravity = Vec3::Zero();               // gravity of the settings [m/s^2]
    ForceIntervals intervals;

    static LoadInputs bind(const Binder& binder, const LoadTable& load, const BodyTable& body, const NodeTable& node,
                           const Vec3& gravity, const ForceIntervals& intervals) {
        return {.kind = binder.read(load.kind),
                .load_body = binder.read(load.body),
                .vector = binder.read(load.vector),
                .rate = binder.read(load.rate),
                .area = binder.read(load.area),
                .load_nodes = binder.read(load.nodes),
                .scale_keys = binder.read(load.scale_keys),
                .share_node = binder.read(load.node),
                .weight = binder.read(load.weight),
                .key = binder.read(load.key),
                .body_kind = binder.read(body.kind),
                .body_nodes = binder.read(body.nodes),
                .body_implicit = binder.read(body.implicit),
                .node_body = binder.read(node.body),
                .mass = binder.read(node.mass),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .gravity = binder.value(gravity),
                .intervals = binder.value(intervals)};
    }

    /// True if `load`, which must be a force field, acts on `body`. A gravity factor given for this body replaces the
    /// factor given for all bodies.
    bool acts_on(std::size_t load, std::size_t body) const;
    bool is_on_present_area(std::size_t load) const {
        return kind[load] == LoadKind::traction && area[load] == LoadArea::present;
    }
    /// Calls visit(first, corners) for each face of a traction on the present area. `first`: index in `share_node` of
    /// the first of the three nodes of the face. `corners`: present positions of these nodes as columns [m].
    void for_each_face(std::size_t load, auto&& visit) const {
        const std::span<const Vec3> node_position =
            rows_of(position, body_nodes[static_cast<std::size_t>(load_body[load])]);
        for (auto k = static_cast<std::size_t>(load_nodes[load].begin);
             k < static_cast<std::size_t>(load_nodes[load].end); k += 3) {
            Mat3 corners;
            for (Index c = 0; c < 3; ++c)
                corners.col(c) = node_position[static_cast<std::size_t>(share_node[k + static_cast<std::size_t>(c)])];
            visit(k, corners);
        }
    }
};

/// Adds the forces of all loads to `applied_force`, by node [N]. Returns false if there is no load. Parallel over
/// nodes, except for tractions on the present area. `fields`: work memory.
/// - A load whose scale changes over time acts with the exact mean of its scale over the force interval of the step
///   (ForceIntervals). The impulses of all steps thus sum to the time integral of the load.
/// - Drag is computed from the velocities at the start of the step, a traction on the present area from the positions
///   at that time.
/// - First the loads on nodes are added in the order of LoadTable, then the sum of all fields.
bool add_loads(Executor& executor, const LoadInputs& loads, Column<BodyField>& fields, std::span<Vec3> applied_force);

/// Upper bound on the increase of omega^2 by a traction on the present area. omega is the highest circular frequency of
/// the explicit body (docs/methods/loads.md 2) [1/s^2]. `inverse_mass`: by node [1/kg].
Real traction_rate(const LoadInputs& loads, std::size_t load, std::span<const Real> inverse_mass);

/// The columns from which mark_loaded finds the bodies whose loads change.
struct LoadedBodies {
    std::span<const Index> load_body;
    std::span<const Range> scale_keys;
    std::span<const TimeKey> key;
    std::span<const BodyKind> body_kind;

    static LoadedBodies bind(const Binder& binder, const LoadTable& load, const BodyTable& body) {
        return {.load_body = binder.read(load.body),
                .scale_keys = binder.read(load.scale_keys),
                .key = binder.read(load.key),
                .body_kind = binder.read(body.kind)};
    }
};

/// Marks each body with a load whose scale changes in the step of length `h` [s] that starts at the time `t` [s]: these
/// bodies must not sleep. Returns false if no load changes.
bool mark_loaded(const LoadedBodies& loads, Real t, Real h, std::span<std::uint8_t> marked);

}  // namespace skerry
