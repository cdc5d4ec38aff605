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

/// A frame that translates with a body but does not rotate. Distances inside a body change only if its nodes move
/// relative to the frame. The distance between two bodies also changes if one frame moves relative to the other. The
/// collision search bounds these two kinds of motion separately. The motion of the frame then does not use up the
/// margins of the search for contacts of a body with itself (docs/methods/collision.md 2).
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
    // Number of core nodes, which define the surface of a round rigid body. They are the first nodes of the body. 0:
    // the body is not round, and its triangles define the surface. Sphere: 1 core node, its centre. Capsule: 2 core
    // nodes, the ends of its axis. The surface of a sphere or capsule is at the distance round_radius [m] from the
    // centre or axis. Cylinder: 3 core nodes, its centre, the centre of one end, and a point on the rim of that end.
    // For a cylinder round_radius is the radius of the bounding ball [m].
    Column<Index> core_nodes;
    Column<Real> round_radius;
    Column<Real> mean_edge;     // mean edge length of the surface in the rest shape [m]
    Column<Real> min_altitude;  // smallest altitude of the elements in the rest shape [m]
    Column<Real> rest_step;     // longest stable step of the body in its rest shape [s]
    Column<Real> stable_step;   // longest stable step of the body in its shape at the last check [s]
    // Step length for which the clusters of the body were made. A cluster is a group of nodes around elements that are
    // integrated implicitly (NodeClusters). These elements are stable up to this step, unless they become stiffer than
    // assumed. 0: the body has no clusters [s].
    Column<Real> cluster_step;
    // 1: the body is asleep. Steps do not compute a sleeping body until it is woken, for example by a contact or a
    // changed load.
    Column<std::uint8_t> asleep;
    Column<GhostKind> ghost;  // derived by note_ghosts; empty in a world that is not divided among ranks
    // 1: the body is asleep or a led ghost, so this step computes no forces on it. Derived by Model::note_rest.
    Column<std::uint8_t> idle;
    // Number of further steps in which the elements of the body are not computed, because the body counts as undeformed
    // and unrotated, so that its elements exert no force. After these steps the body is tested again
    // (find_unstrained.h). 0: the elements are computed.
    Column<std::uint16_t> unstrained;
    // Time for which the body has been still (update_sleep.h) [s].
    Column<Real> still_time;
    // Measurements of stillness (stillness.h), used if SleepSettings::own_limits is set. The sleep time, for which a
    // body must be still before it falls asleep, is divided into two halves. |drift|: largest distance, measured in the
    // current half, of a node from its position at the start of the half (NodeTable::still_position) [m]. The sign of
    // `drift` is a flag. It is negative if a measurement was below an earlier one: the body then does not move steadily
    // in one direction. `drift_before`: |drift| at the end of the previous half [m].
    Column<Real> drift, drift_before;
    // `shape_drift`: largest distance, measured in the current half of the sleep time, between the shape of the body
    // and its shape at the start of the half (stillness.h: shape_distance) [m]. `creep_before` serves to detect a shape
    // that creeps in one direction. It is shape_drift at the end of the previous half if the last measurement of that
    // half gave the largest distance. Otherwise the shape had begun to move back, and `creep_before` is 0 [m].
    Column<Real> shape_drift, creep_before;
    Column<Real> max_speed;  // greatest speed of a node in this step [m/s]
    Column<MovingFrame> frame;
    // The next columns are measured in the moving frame of the body.
    Column<Real> frame_speed;  // greatest speed of a node relative to the frame in this step [m/s]
    // Greatest displacement of a node relative to the frame since the last reset of this column to zero [m]: the
    // maximum of |position - displacement_origin - frame.offset|. A reset stores the present positions in
    // displacement_origin.
    Column<Real> displacement;
    // Counter that bounds how far nodes move relative to the frame [m]. It is the sum of the changes of `displacement`,
    // except its resets to zero. Since an earlier time t, no node has moved relative to the frame by more than travel -
    // travel(t) + 2 displacement(t), where (t) marks the values at the time t (docs/methods/collision.md 2.1).
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
