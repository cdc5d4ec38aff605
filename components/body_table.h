// One row per body: ranges of rows in the other tables, and the state of the body as a whole.
#pragma once

#include <cstdint>

#include "components/bvh_table.h"
#include "components/collision_filter.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/material_table.h"
#include "components/range.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

enum class BodyKind : std::uint8_t {
    deformable,
    kinematic,  // body of a mesh collider: its nodes have no elements and move with the collider
};
template <>
inline constexpr std::uint64_t value_count<BodyKind> = 2;

/// A frame that translates with a body but does not rotate. Distances within a body change only by the motion of its
/// nodes in the frame. The distance of two bodies changes also by the relative motion of their frames, but not by the
/// motion that both frames share.
struct MovingFrame {
    Vec3 velocity = Vec3::Zero();  // mean velocity of the nodes when BodyTable::displacement was last zero [m/s]
    Vec3 offset = Vec3::Zero();    // displacement of the frame since BodyTable::displacement was last zero [m]
    Vec3 position = Vec3::Zero();  // displacement of the frame since the body was added [m]
    Real path = 0;                 // length of the path of the frame since the body was added [m]
};
template <>
struct NumbersOf<MovingFrame> : Reals<10> {};

struct BodyTable {
    Column<std::uint32_t> slot;  // handle slot of the body; for a kinematic body the slot of its collider
    Column<BodyKind> kind;
    Column<std::uint8_t> self_contact;
    Column<Index> material;             // row of MaterialTable; no_index for a kinematic body
    Column<SurfaceProperties> surface;  // surface properties; where negative, those of the material are used
    Column<CollisionFilter> filter;     // collision filter; for a kinematic body the filter of its collider is used
    Column<Index> collider;             // row of ColliderTable for a kinematic body, else no_index
    Column<Range> nodes;
    Column<Range> node_blocks;
    Column<Range> blocks;         // rows of ElementBlockTable
    Column<Range> element_nodes;  // rows of ElementNodeTable
    Column<Range> tetrahedron_blocks;
    Column<Range> rigid;     // rows of RigidBodyTable: one row if the body is rigid or implicit, else none
    Column<Range> implicit;  // rows of ImplicitNodeTable: one row per node if the body is implicit, else none
    Column<Range> triangles;
    Column<Range> edges;
    Column<Range> vertices;
    Column<Range> bvh_nodes;
    Column<Range> bvh_leaves;
    Column<Index> tetrahedron_count;
    Column<Index> pinned_count;     // number of nodes without degrees of freedom
    Column<Real> contact_distance;  // thickness of the contact shell; a pair of bodies uses the mean of both [m]
    // Number of core nodes of a round rigid body: its first nodes. 0: the body is not round and has triangles. A sphere
    // has 1 core node, its centre. A capsule has 2, the ends of its axis. The surface of a sphere or capsule has the
    // distance round_radius from the core. A cylinder has 3, which define its surface: its centre, the centre of one
    // end, and a point on the rim of that end. For a cylinder round_radius is the radius of the bounding ball [m].
    Column<Index> core_nodes;
    Column<Real> round_radius;
    Column<Real> mean_edge;     // mean edge length of the surface in the rest shape [m]
    Column<Real> min_altitude;  // smallest altitude of the elements in the rest shape [m]
    Column<Real> rest_step;     // stable step of the rest shape [s]
    Column<Real> stable_step;   // stable step found by the last check [s]
    // Longest step at which the implicit elements are stable; 0 without implicit elements [s].
    Column<Real> cluster_step;
    // 1: the body is asleep; steps leave it out until something touches it.
    Column<std::uint8_t> asleep;
    // Number of steps until find_unstrained.h checks the body again. Until then the body counts as undeformed and
    // unrotated, so its elements exert no force and are not computed. 0: the elements are computed.
    Column<std::uint16_t> unstrained;
    // Time for which the body has been still (update_sleep.h) [s].
    Column<Real> still_time;
    // With the engine's own limits, the sleep time is divided into two halves. `drift`: largest distance of a node from
    // its still_position in the current half [m]. Its sign is negative if a later measurement found a smaller distance.
    // `drift_before`: largest such distance in the previous half [m].
    Column<Real> drift, drift_before;
    // `shape_drift`: largest distance of the shape in the current half from the shape at the start of the half,
    // still_position [m] (stillness.h: shape_distance). `creep_before`: largest distance in the previous half if it
    // occurred at the end of the half, else 0 [m].
    Column<Real> shape_drift, creep_before;
    Column<Real> max_speed;  // greatest speed of a node in this step [m/s]
    Column<MovingFrame> frame;
    // Quantities measured in the moving frame of the body:
    Column<Real> frame_speed;  // greatest speed of a node in this step, relative to the frame [m/s]
    // Greatest distance of a node from its displacement_origin, which moves with the frame [m].
    Column<Real> displacement;
    // Bound on the motion of nodes relative to the frame [m]. Since any earlier time, no node has moved further than
    // the growth of `travel` since that time plus twice the `displacement` at that time.
    Column<Real> travel;
    Column<Real> uninverted_until;  // no tetrahedron changes the sign of its volume while `travel` is below this [m]

    /// Visits all columns; the only list of them. Model::rebuild_outlines derives the columns `triangles` to
    /// `bvh_leaves`.
    void for_each_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("kind", kind, ColumnRole::state);
        visit("self_contact", self_contact, ColumnRole::state);
        visit("material", material, ColumnRole::link);
        visit("surface", surface, ColumnRole::link);
        visit("filter", filter, ColumnRole::link);
        visit("collider", collider, ColumnRole::link);
        visit("nodes", nodes, ColumnRole::link);
        visit("node_blocks", node_blocks, ColumnRole::link);
        visit("blocks", blocks, ColumnRole::link);
        visit("element_nodes", element_nodes, ColumnRole::link);
        visit("tetrahedron_blocks", tetrahedron_blocks, ColumnRole::link);
        visit("rigid", rigid, ColumnRole::link);
        visit("implicit", implicit, ColumnRole::link);
        visit("triangles", triangles, ColumnRole::derived);
        visit("edges", edges, ColumnRole::derived);
        visit("vertices", vertices, ColumnRole::derived);
        visit("bvh_nodes", bvh_nodes, ColumnRole::derived);
        visit("bvh_leaves", bvh_leaves, ColumnRole::derived);
        visit("tetrahedron_count", tetrahedron_count, ColumnRole::state);
        visit("pinned_count", pinned_count, ColumnRole::state);
        visit("contact_distance", contact_distance, ColumnRole::state);
        visit("core_nodes", core_nodes, ColumnRole::state);
        visit("round_radius", round_radius, ColumnRole::state);
        visit("mean_edge", mean_edge, ColumnRole::state);
        visit("min_altitude", min_altitude, ColumnRole::state);
        visit("rest_step", rest_step, ColumnRole::state);
        visit("stable_step", stable_step, ColumnRole::state);
        visit("cluster_step", cluster_step, ColumnRole::state);
        visit("asleep", asleep, ColumnRole::state);
        visit("unstrained", unstrained, ColumnRole::memory);
        visit("still_time", still_time, ColumnRole::state);
        visit("drift", drift, ColumnRole::state);
        visit("drift_before", drift_before, ColumnRole::state);
        visit("shape_drift", shape_drift, ColumnRole::state);
        visit("creep_before", creep_before, ColumnRole::state);
        visit("max_speed", max_speed, ColumnRole::state);
        visit("frame", frame, ColumnRole::memory);
        visit("frame_speed", frame_speed, ColumnRole::memory);
        visit("displacement", displacement, ColumnRole::memory);
        visit("travel", travel, ColumnRole::memory);
        visit("uninverted_until", uninverted_until, ColumnRole::memory);
    }
};

/// Pairs of bodies that rows of other tables join, such as joints. Joined bodies are put to rest and wake together.
struct BodyLinks {
    Column<Index> first, second;  // rows of BodyTable
};

}  // namespace skerry
