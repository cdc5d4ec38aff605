// One row per body: ranges into the other tables, and its state as a whole.
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
    kinematic,  // a mesh collider: nodes without elements, moved by its collider
};
template <>
inline constexpr std::uint64_t value_count<BodyKind> = 2;

/// A frame that moves with a body without turning. Distances between bodies, and within one, change by what nodes move
/// in their frames and by what the frames move against each other: common motion costs nothing.
struct MovingFrame {
    Vec3 velocity = Vec3::Zero();  // m/s, the mean of the nodes' when the displacement was last zero
    Vec3 offset = Vec3::Zero();    // m, how far it has come since then
    Vec3 position = Vec3::Zero();  // m, how far since the body was added
    Real path = 0;                 // m, the length of that way
};
template <>
struct NumbersOf<MovingFrame> : Reals<10> {};

struct BodyTable {
    Column<std::uint32_t> slot;  // handle slot of the body, or of the collider that a kinematic body belongs to
    Column<BodyKind> kind;
    Column<std::uint8_t> self_contact;
    Column<Index> material;             // row of MaterialTable; no_index for a kinematic body
    Column<SurfaceProperties> surface;  // a property below zero: that of its material
    Column<CollisionFilter> filter;     // whom it touches; of a kinematic body that of its collider counts
    Column<Index> collider;             // row of ColliderTable of a kinematic body, else no_index
    Column<Range> nodes;
    Column<Range> node_blocks;
    Column<Range> blocks;         // of ElementBlockTable
    Column<Range> element_nodes;  // of ElementNodeTable
    Column<Range> tetrahedron_blocks;
    Column<Range> rigid;     // of RigidBodyTable: one row of what moves by it, rigid or implicit, else none
    Column<Range> implicit;  // of ImplicitNodeTable: a row a node of a body that moves implicitly, else none
    Column<Range> triangles;
    Column<Range> edges;
    Column<Range> vertices;
    Column<Range> bvh_nodes;
    Column<Range> bvh_leaves;
    Column<Index> tetrahedron_count;
    Column<Index> pinned_count;     // nodes without freedom
    Column<Real> contact_distance;  // m, thickness of the contact shell; two bodies keep the mean of theirs
    // Of a rigid body that is round: its core is its first nodes, the middle of a sphere or the two ends of the axis of
    // a capsule, and its surface is as far from the core as its radius, m. Of a cylinder three: its middle, that of one
    // end, and a place of the rim there, which say where its surface is; the radius is that of the ball around it. 0:
    // it has triangles
    Column<Index> core_nodes;
    Column<Real> round_radius;
    Column<Real> mean_edge;     // m, of the surface at rest
    Column<Real> min_altitude;  // m, of the elements at rest
    Column<Real> rest_step;     // s, stable step of the rest shape
    Column<Real> stable_step;   // s, as last watched
    Column<Real> cluster_step;  // s, the longest that its implicit elements stand; 0 where it has none
    // at rest: left out of the step until something touches it
    Column<std::uint8_t> asleep;
    // 0, or the steps for which it is taken to be as it was made but for a motion without a turn, so that its elements
    // do nothing, until that is looked at again (find_unstrained.h)
    Column<std::uint16_t> unstrained;
    // s, for how long the body has been still (update_sleep.h); and, with the engine's own limits, how far a node has
    // come from its still_position, m: in this half of sleep_time, below 0 once it has come nearer again; in the one
    // before
    Column<Real> still_time;
    Column<Real> drift, drift_before;
    // m, how far its shape has come from that at the still_position in this half; and in the one before, where it went
    // one way, else 0
    Column<Real> shape_drift, creep_before;
    Column<Real> max_speed;  // m/s, of this step's motion
    Column<MovingFrame> frame;
    // In the frame:
    Column<Real> frame_speed;   // m/s, greatest of this step's motion
    Column<Real> displacement;  // m, greatest distance of a node from its displacement origin
    // m: since any earlier time no node has come further than the growth of travel plus twice the displacement then
    Column<Real> travel;
    Column<Real> uninverted_until;  // m: the least of the body's tetrahedra

    /// The only list of columns. Derived: triangles to bvh_leaves by Model::rebuild_outlines.
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

}  // namespace skerry
