// Position and velocity of anchors, and the distribution of forces at anchors to nodes. An anchor is a point to which a
// spring or cable is attached. It is on a body, on a collider or fixed in the world.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "components/anchor.h"
#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/node_table.h"
#include "jobs/access.h"

namespace skerry {

/// Anchors, and the columns that determine their positions. NodeTable contains the node positions and velocities of
/// bodies of every kind, also of rigid ones. So the functions below need not distinguish kinds of bodies.
struct AnchorInputs {
    std::span<const Index> body, collider;  // AnchorColumns
    std::span<const AnchorRow> point;
    std::span<const Range> body_nodes;              // BodyTable
    std::span<const Vec3> position, node_velocity;  // NodeTable [m, m/s]
    std::span<const RigidMotion> motion;            // ColliderTable

    static AnchorInputs bind(const Binder& binder, const AnchorColumns& anchor, const BodyTable& bodies,
                             const NodeTable& nodes, const ColliderTable& colliders) {
        return {.body = binder.read(anchor.body),
                .collider = binder.read(anchor.collider),
                .point = binder.read(anchor.point),
                .body_nodes = binder.read(bodies.nodes),
                .position = binder.read(nodes.position),
                .node_velocity = binder.read(nodes.velocity),
                .motion = binder.read(colliders.motion)};
    }

    /// Calls visit(node, weight) for each node that moves an anchor: each node with a nonzero weight in the anchor.
    /// Visits nothing if the anchor is not on a body. `node` is a row of NodeTable.
    void for_each_node(std::size_t anchor, auto&& visit) const {
        if (body[anchor] == no_index) return;
        const Index first = body_nodes[static_cast<std::size_t>(body[anchor])].begin;
        for (std::size_t a = 0; a < 4; ++a)
            if (const Real weight = point[anchor].weight[a]; weight != 0)
                visit(static_cast<std::size_t>(first + point[anchor].node[a]), weight);
    }

    /// True if an anchor is on a collider that moves in this step.
    bool is_led(std::size_t anchor) const {
        const Index held_by = collider[anchor];
        return held_by != no_index && !motion[static_cast<std::size_t>(held_by)].stands_still();
    }

    /// Present position of an anchor [m].
    Vec3 at(std::size_t anchor) const {
        if (body[anchor] == no_index) {
            if (collider[anchor] == no_index) return point[anchor].point;
            const RigidMotion& pose = motion[static_cast<std::size_t>(collider[anchor])];
            return pose.position + pose.rotation * point[anchor].point;
        }
        Vec3 sum = Vec3::Zero();
        for_each_node(anchor, [&](std::size_t node, Real weight) { sum += weight * position[node]; });
        return sum;
    }

    /// Velocity of an anchor [m/s].
    Vec3 velocity(std::size_t anchor) const {
        if (body[anchor] == no_index) {
            if (collider[anchor] == no_index) return Vec3::Zero();
            const RigidMotion& pose = motion[static_cast<std::size_t>(collider[anchor])];
            return pose.velocity + pose.angular_velocity.cross(pose.rotation * point[anchor].point);
        }
        Vec3 sum = Vec3::Zero();
        for_each_node(anchor, [&](std::size_t node, Real weight) { sum += weight * node_velocity[node]; });
        return sum;
    }

    /// Adds the force `force` at an anchor to the forces on nodes [N]. The nodal forces together have the same
    /// resultant and moment as `force`. Does nothing for an anchor on a collider or on the world.
    void add_force(std::size_t anchor, const Vec3& force, std::span<Vec3> node_force) const {
        for_each_node(anchor, [&](std::size_t node, Real weight) { node_force[node] += weight * force; });
    }
};

}  // namespace skerry
