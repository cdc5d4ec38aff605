// Corrects the drag on the rotation of rigid bodies (docs/methods/loads.md).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/node_table.h"
#include "components/rigid_body_table.h"
#include "components/types.h"
#include "jobs/access.h"
#include "systems/forces/add_loads.h"

namespace skerry {

struct DraggedBodies {
    std::span<const Index> body;                     // BodyTable row of each rigid or implicit body
    std::span<const Vec3> center, angular_momentum;  // [m], [kg m^2/s]
    // Columns of BodyTable and NodeTable:
    std::span<const Range> body_nodes, body_implicit;
    std::span<const Real> mass;                // [kg]
    std::span<const Vec3> position, velocity;  // state at the start of the step [m, m/s]

    static DraggedBodies bind(const Binder& binder, const RigidBodyTable& rigid, const BodyTable& body,
                              const NodeTable& node) {
        return {.body = binder.read(rigid.body),
                .center = binder.read(rigid.center),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .body_nodes = binder.read(body.nodes),
                .body_implicit = binder.read(body.implicit),
                .mass = binder.read(node.mass),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity)};
    }
};

/// Corrects the moment of the drag on rigid bodies: about the centre of mass it should be -drag L, with the angular
/// momentum L of the body. Adds nodal forces that sum to zero and have the missing moment. Returns false if there is no
/// rigid or implicit body. `fields`: from add_loads().
///
/// add_loads() has added the drag of the single nodes to `applied_force`, by node [N]. Its moment is -drag times the
/// angular momentum of the node masses, which differs from L. Since some node masses may be negative, it could even
/// speed up the rotation.
///
/// If all nodes lie on a line, the couple about this line is left out, because nodal forces cannot exert it.
bool add_drag_couples(const DraggedBodies& bodies, std::span<const BodyField> fields, std::span<Vec3> applied_force);

}  // namespace skerry
