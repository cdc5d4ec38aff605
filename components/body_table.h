// One row per body: the ranges of its rows in the other tables, and the state of the body.
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

/// A ghost is a copy of a body that another rank owns. Ranks are processes that simulate one world together
/// (engine/world/ranks).
enum class GhostKind : std::uint8_t {
    none,  // this rank owns the body
    twin,  // this rank computes the ghost completely, like the owner
    led,   // this rank computes no forces of the ghost, and receives its predicted velocities from the owner
};

/// Frame that translates with a body but does not rotate. The collision search bounds two motions separately: that of
/// the nodes in the frame, and that of the frame. Only the first changes distances inside a body
/// (docs/methods/collision.md 2).
struct MovingFrame {
    Vec3 velocity = Vec3::Zero();  // mean velocity of the nodes when BodyTable::displacement was last zero [m/s]
    Vec3 offset = Vec3::Zero();    // displacement of the frame since BodyTable::displacement was last zero [m]
    Vec3 position = Vec3::Zero();  // displacement of the frame since the body was added [m]
    Real path = 0;                 // length of the path of the frame since the body was added [m]
};
template <>
struct NumbersOf<MovingFrame> : Reals<10> {};

struct BodyTable {
    Column<std::uint32_t> slot;  // handle slot of the body; for a kinematic body: handle slot of its collider
    Column<BodyKind> kind;
    Column<std::uint8_t> self_contact;
    Column<Index> material;  // row of MaterialTable; no_index for a kinematic body
    // surface properties of the body; a negative property is replaced by the property of the material
    Column<SurfaceProperties> surface;
    // collision filter of the body; a kinematic body uses the filter of its collider instead
    Column<CollisionFilter> filter;
    Column<Index> collider;  // row of ColliderTable for a kinematic body, else no_index
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
    Column<Index> pinned_count;  // number of nodes without degrees of freedom
    // thickness of the layer around the surface in which contacts act; two bodies in contact use the mean of their
    // thicknesses [m]
    Column<Real> contact_distance;
    // Number of core nodes: the first nodes of a round rigid body, which define its surface. 0: the body is not round.
    // - sphere: 1 core node, its centre
    // - capsule: 2 core nodes, the ends of its axis
    // - cylinder: 3 core nodes, its centre, the centre of one end, and a point on the rim of that end
    Column<Index> core_nodes;
    // distance of the surface from the centre of a sphere or the axis of a capsule; for a cylinder: radius of the
    // bounding ball [m]
    Column<Real> round_radius;
    Column<Real> mean_edge;     // mean edge length of the surface in the rest shape [m]
    Column<Real> min_altitude;  // smallest altitude of the elements in the rest shape [m]
    Column<Real> rest_step;     // longest stable step of the body in its rest shape [s]
    Column<Real> stable_step;   // longest stable step of the body in its shape at the last check [s]
    // Longest step for which the clusters of the body are stable, unless their elements become stiffer than assumed; 0:
    // the body has no clusters [s]. A cluster is a group of nodes around elements that are integrated implicitly
    // (NodeClusters).
    Column<Real> cluster_step;
    // 1: the body is asleep. Steps do not compute a sleeping body until it is woken, for example by a contact or a
    // changed load.
    Column<std::uint8_t> asleep;
    Column<GhostKind> ghost;  // derived by note_ghosts; empty in a world that is not divided among ranks
    // 1: the body is asleep or a led ghost, so this step computes no forces on it. Derived by Model::note_rest.
    Column<std::uint8_t> idle;
    // Number of further steps in which the elements of the body are not computed, because it counts as undeformed and
    // unrotated and they exert no force. Then the body is tested again (find_unstrained.h). 0: the elements are
    // computed.
    Column<std::uint16_t> unstrained;
    // Time for which the body has been still (update_sleep.h) [s].
    Column<Real> still_time;
    // Measurements of stillness, used if SleepSettings::own_limits is set (stillness.h). A body falls asleep after it
    // has been still for the sleep time, which is divided into two halves.
    // - |drift|: largest distance of a node from its position at the start of the present half
    //   (NodeTable::still_position) [m]
    // - drift < 0: a measurement was below an earlier one, so the body does not move steadily in one direction
    // - drift_before: |drift| at the end of the previous half [m]
    Column<Real> drift, drift_before;
    // `shape_drift`: largest distance in the present half of the sleep time between the shape of the body and its shape
    // at the start of the half (stillness.h: shape_distance) [m].
    //
    // `creep_before`: shape_drift at the end of the previous half, to detect a shape that creeps in one direction; 0 if
    // the last measurement of that half was below an earlier one, because the shape had begun to move back [m].
    Column<Real> shape_drift, creep_before;
    Column<Real> max_speed;  // greatest speed of a node in this step [m/s]
    Column<MovingFrame> frame;
    // The next columns are measured in the moving frame of the body.
    Column<Real> frame_speed;  // greatest speed of a node relative to the frame in this step [m/s]
    // Greatest displacement of a node relative to the frame since the last reset of this column to zero [m]: the
    // maximum of |position - displacement_origin - frame.offset|. A reset stores the present positions in
    // displacement_origin.
    Column<Real> displacement;
    // Counter that bounds how far nodes move relative to the frame: the sum of the changes of `displacement`, without
    // its resets to zero [m]. Let travel_0 and displacement_0 be the values at an earlier time. Since then no node has
    // moved by more than travel - travel_0 + 2 displacement_0 (docs/methods/collision.md 2.1).
    Column<Real> travel;
    // no tetrahedron of the body changes the sign of its volume while `travel` is below this value [m]
    Column<Real> uninverted_until;

    bool is_ghost(std::size_t row) const { return !ghost.empty() && ghost[row] != GhostKind::none; }
    bool is_led(std::size_t row) const { return !ghost.empty() && ghost[row] == GhostKind::led; }

    /// Visits all columns. This is the only list of the columns. Model::rebuild_outlines derives the columns
    /// `triangles` to `bvh_leaves`.
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
        visit("ghost", ghost, ColumnRole::derived);
        visit("idle", idle, ColumnRole::derived);
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

/// Pairs of bodies that are connected by a row of another table, for example by a joint. Connected bodies fall asleep
/// together and wake together.
struct BodyLinks {
    Column<Index> first, second;  // rows of BodyTable
};

}  // namespace skerry
