// Groups of nodes whose velocities are coupled: the nodes of a rigid body, and the nodes of a cluster (nodes with a
// common inertia matrix).
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "components/body_table.h"
#include "components/cable_table.h"
#include "components/contact_table.h"
#include "components/joint_table.h"
#include "components/node_block_table.h"
#include "components/node_clusters.h"
#include "components/node_table.h"
#include "components/range.h"
#include "components/rigid_body_table.h"
#include "jobs/access.h"

namespace skerry {

/// Contact points and distances of ContactTable. Only cylinders need them. On a sphere or capsule the contact point is
/// one radius away from the core (centre or axis), on the line of the normal. On a cylinder the normal alone does not
/// determine it.
struct TouchPoints {
    std::span<const Vec3> point{};
    std::span<const Real> distance{};

    static TouchPoints bind(const Binder& binder, const ContactTable& contact) {
        return {.point = binder.read(contact.point), .distance = binder.read(contact.distance)};
    }

    /// Contact point on the surface of the first partner (`weight` > 0) or of the second partner [m].
    Vec3 on(Real weight, std::size_t contact, const Vec3& normal) const {
        return weight > 0 ? Vec3(point[contact] + distance[contact] * normal) : point[contact];
    }
};

struct RigidNodes {
    std::span<const Index> node_body;      // NodeTable
    std::span<const Range> body_nodes;     // BodyTable
    std::span<const Range> body_rigid;     // column of BodyTable; empty if no body is rigid or implicit
    std::span<const Real> round_radius{};  // column of BodyTable; empty if no body is rigid or implicit
    std::span<const Index> core_nodes{};   // column of BodyTable; empty if no body is rigid or implicit
    std::span<const Vec3> center{};        // column of RigidBodyTable; empty if no body is rigid or implicit

    static RigidNodes bind(const Binder& binder, const NodeTable& node, const BodyTable& body,
                           const RigidBodyTable& rigid) {
        const bool any = !binder.read(rigid.mass).empty();
        return {.node_body = binder.read(node.body),
                .body_nodes = binder.read(body.nodes),
                .body_rigid = binder.read_if(any, body.rigid),
                .round_radius = binder.read_if(any, body.round_radius),
                .core_nodes = binder.read_if(any, body.core_nodes),
                .center = binder.read_if(any, rigid.center)};
    }

    bool any() const { return !body_rigid.empty(); }
    /// Row of RigidBodyTable of the rigid or implicit body to which a node belongs, or no_index.
    Index row(Index node) const {
        if (!any()) return no_index;
        const Range rows = body_rigid[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])];
        return rows.size() > 0 ? rows.begin : no_index;
    }
    /// Radius of the round body to which the node belongs; 0 if the body is not round [m].
    Real radius(Index node) const {
        return round_radius.empty() ? 0
                                    : round_radius[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])];
    }
    bool is_cylinder(Index node) const {
        return !core_nodes.empty() &&
               core_nodes[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])] == cylinder_core_nodes;
    }
    /// Moment arm of a contact on a round body [m]: the vector from a point on its core to the contact point, times
    /// `weight`, the sum of the weights of its nodes (1 for the first partner, -1 for the second).
    /// - Sphere or capsule: the point is the nearest core point, so the arm is -radius normal for both partners.
    /// - Cylinder: the point is the centre.
    Vec3 core_arm(Index node, Real weight, std::size_t contact, const Vec3& normal,
                  const TouchPoints& touch_points) const {
        if (!is_cylinder(node)) return -radius(node) * normal;
        return weight * (touch_points.on(weight, contact, normal) - center[static_cast<std::size_t>(row(node))]);
    }
    /// Part of the relative velocity at a contact that stems from the spins of round bodies [m/s]. `spin(r)`: spin of
    /// row r of RigidBodyTable [rad/s].
    Vec3 rolling(const Stencil& stencil, std::size_t contact, const Vec3& normal, const TouchPoints& touch_points,
                 auto&& spin) const {
        Vec3 sum = Vec3::Zero();
        if (round_radius.empty()) return sum;
        for (std::size_t a = 0; a < 4; ++a) {
            const Index node = stencil.node[a];
            const Real weight = stencil.weight[a];
            if (weight == 0 || !(radius(node) > 0)) continue;
            const Vec3 turning = spin(static_cast<std::size_t>(row(node)));
            if (is_cylinder(node))
                sum += turning.cross(core_arm(node, weight, contact, normal, touch_points));
            else
                sum -= std::abs(weight) * radius(node) * turning.cross(normal);
        }
        return sum;
    }
    /// The first node of the rigid or implicit body that contains `node`; `node` itself if its body is explicit.
    Index leader(Index node) const {
        return row(node) == no_index
                   ? node
                   : body_nodes[static_cast<std::size_t>(node_body[static_cast<std::size_t>(node)])].begin;
    }
};

/// Angular velocities (spins) of rigid bodies, by row of RigidBodyTable.
struct RigidSpins {
    std::span<const Mat3> inverse_inertia{};  // inverse inertia in the world frame [1/(kg m^2)]
    std::span<const Vec3> angular_momentum{}, moment_kick{};

    static RigidSpins bind(const Binder& binder, const RigidBodyTable& rigid) {
        return {.inverse_inertia = binder.read(rigid.inverse_inertia),
                .angular_momentum = binder.read(rigid.angular_momentum),
                .moment_kick = binder.read(rigid.moment_kick)};
    }

    /// Spin at the start of the step [rad/s].
    Vec3 before(std::size_t r) const { return inverse_inertia[r] * angular_momentum[r]; }
    /// Spin after the kick of this step (moments of gravity and loads), before the contacts act [rad/s].
    Vec3 kicked(std::size_t r) const { return inverse_inertia[r] * (angular_momentum[r] + moment_kick[r]); }
};

/// The cables that the region solver solves, with their columns by point (CableBlockTable).
struct SolvedCables {
    std::span<const CableBlock> block{};
    std::span<const Stencil> stencil{};
    std::span<const Vec3> velocity{}, direction{};
    std::span<const Real> most_ratio{};

    static SolvedCables bind(const Binder& binder, const CableBlockTable& cables) {
        const auto first = static_cast<std::size_t>(binder.read(cables.first_solved));
        const std::span<const CableBlock> all = binder.read(cables.block);
        return {.block = all.subspan(std::min(first, all.size())),
                .stencil = binder.read(cables.stencil),
                .velocity = binder.read(cables.velocity),
                .direction = binder.read(cables.direction),
                .most_ratio = binder.read(cables.most_ratio)};
    }

    /// Calls visit(node) for each node of a cable that impulses can move.
    void for_each_moving_node(std::size_t cable, std::span<const Real> inverse_mass, auto&& visit) const {
        for (const Stencil& point_stencil : rows_of(stencil, block[cable].points))
            for (std::size_t a = 0; a < 4; ++a)
                if (point_stencil.weight[a] != 0 && inverse_mass[static_cast<std::size_t>(point_stencil.node[a])] > 0)
                    visit(point_stencil.node[a]);
    }
};

/// Connections between nodes, for the search for contact regions: groups of nodes, joints and cables. A group is a
/// rigid or implicit body, or a cluster (nodes with a common inertia matrix). No node is in a rigid body and in a
/// cluster at the same time.
struct NodeGroups {
    const NodeClusters* clusters = nullptr;  // null: none
    RigidNodes rigid{};
    std::span<const JointBlock> joints{};
    SolvedCables cables{};
    // For each body: 1 if another rank solves the equations of its joints, ties and cables. Empty: this rank solves all
    // equations.
    std::span<const std::uint8_t> elsewhere{};

    static NodeGroups bind(const Binder& binder, const NodeClusters& clusters, const NodeTable& node,
                           const BodyTable& body, const RigidBodyTable& rigid, const JointBlockTable& joints,
                           const CableBlockTable& cables, const Column<std::uint8_t>& elsewhere) {
        // binder.value() declares only these columns as read. The matrices of the clusters are not read here, so other
        // tasks may write them at the same time.
        binder.value(clusters.nodes);
        binder.value(clusters.body);
        binder.value(clusters.cluster_of);
        return {.clusters = &clusters,
                .rigid = RigidNodes::bind(binder, node, body, rigid),
                .joints = binder.read(joints.block),
                .cables = SolvedCables::bind(binder, cables),
                .elsewhere = binder.read(elsewhere)};
    }

    /// True if another rank solves the equations of the joints, ties and cables that act on a node.
    bool is_on_other_rank(Index node) const {
        return !elsewhere.empty() &&
               elsewhere[static_cast<std::size_t>(rigid.node_body[static_cast<std::size_t>(node)])] != 0;
    }
    bool empty() const {
        return (clusters == nullptr || clusters->empty()) && !rigid.any() && joints.empty() && cables.block.empty();
    }
    /// The first node of the group that contains `node`; `node` itself if it belongs to no group.
    Index leader(Index node) const { return rigid.leader(clusters == nullptr ? node : clusters->leader(node)); }
    /// For each cable, joins the sets of the nodes that it connects. `sets`: union-find structure; each of its sets
    /// becomes a contact region.
    void join_cables(std::span<const Real> inverse_mass, auto& sets) const {
        for (std::size_t c = 0; c < cables.block.size(); ++c) {
            Index first = no_index;
            cables.for_each_moving_node(c, inverse_mass, [&](Index node) {
                if (first == no_index) first = leader(node);
                sets.join(first, leader(node));
            });
        }
    }
    /// Sets contact_region to no_index for those rows of ContactTable that another rank (process) solves. These rows
    /// are ties and contacts of held nodes. Contacts of moving nodes are not among them, because they have already been
    /// sent to that rank.
    void leave_out_other_ranks(std::span<const Stencil> stencil, std::span<Index> contact_region) const {
        if (elsewhere.empty()) return;
        for (std::size_t i = 0; i < stencil.size(); ++i)
            if (is_on_other_rank(stencil[i].node[0])) contact_region[i] = no_index;
    }
    /// A node that impulses of the joint `joint` can move; the region of this node is the region of the joint.
    Index node_of_joint(std::size_t joint) const { return joints[joint].moving_node(); }
    /// The leader of a node that impulses of the cable `cable` can move; the region of this leader is the region of the
    /// cable.
    Index node_of_cable(std::size_t cable, std::span<const Real> inverse_mass) const {
        Index found = no_index;
        cables.for_each_moving_node(cable, inverse_mass, [&](Index node) {
            if (found == no_index) found = leader(node);
        });
        return found;
    }
};

}  // namespace skerry
