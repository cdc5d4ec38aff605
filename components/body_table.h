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

/// A frame that translates with a body but does not rotate. Distances between bodies, and within a body, change only by
/// the motion of nodes in their frames and by the relative motion of the frames. Common motion therefore changes no
/// distance.
struct MovingFrame {
    Vec3 velocity = Vec3::Zero();  // mean velocity of the nodes when the displacement was last zero [m/s]
    Vec3 offset = Vec3::Zero();    // displacement of the frame since then [m]
    Vec3 position = Vec3::Zero();  // displacement of the frame since the body was added [m]
    Real path = 0;                 // length of its path since the body was added [m]
};
template <>
struct NumbersOf<MovingFrame> : Reals<10> {};

struct BodyTable {
    Column<std::uint32_t> slot;  // handle slot of the body, or of the collider that a kinematic body belongs to
    Column<BodyKind> kind;
    Column<std::uint8_t> self_contact;
    Column<Index> material;             // row of MaterialTable; no_index for a kinematic body
    Column<SurfaceProperties> surface;  // a negative property is taken from the material
    Column<CollisionFilter> filter;     // a kinematic body uses the filter of its collider instead
    Column<Index> collider;             // row of ColliderTable of a kinematic body, else no_index
    Column<Range> nodes;
    Column<Range> node_blocks;
    Column<Range> blocks;         // of ElementBlockTable
    Column<Range> element_nodes;  // of ElementNodeTable
    Column<Range> tetrahedron_blocks;
    Column<Range> rigid;     // of RigidBodyTable: one row if the body is rigid or implicit, else empty
    Column<Range> implicit;  // of ImplicitNodeTable: one row per node if the body is implicit, else empty
    Column<Range> triangles;
    Column<Range> edges;
    Column<Range> vertices;
    Column<Range> bvh_nodes;
    Column<Range> bvh_leaves;
    Column<Index> tetrahedron_count;
    Column<Index> pinned_count;     // nodes without degrees of freedom
    Column<Real> contact_distance;  // thickness of the contact shell; two bodies use the mean of theirs [m]
    // Core of a round rigid body: its first nodes. Sphere: 1, its centre. Capsule: 2, the ends of its axis. The surface
    // of both is at distance round_radius from the core. Cylinder: 3, its centre, the centre of one end and a point of
    // the rim there, which define its surface; round_radius is then the radius of the bounding ball [m]. 0: the body is
    // not round and has triangles
    Column<Index> core_nodes;
    Column<Real> round_radius;
    Column<Real> mean_edge;     // of the surface at rest [m]
    Column<Real> min_altitude;  // of the elements at rest [m]
    Column<Real> rest_step;     // stable step of the rest shape [s]
    Column<Real> stable_step;   // stable step at the last check [s]
    Column<Real> cluster_step;  // longest step at which its implicit elements are stable; 0 if it has none [s]
    // 1: the body is at rest and left out of the step until something touches it
    Column<std::uint8_t> asleep;
    // Steps until find_unstrained.h checks the body again; until then it counts as undeformed and unrotated, so that
    // its elements give no force. 0: the elements are computed
    Column<std::uint16_t> unstrained;
    // Time for which the body has been still (update_sleep.h) [s]. With the engine's own limits sleep_time has two
    // halves. `drift` is the largest distance of a node from its still_position in this half, negative once a later
    // check found it nearer again; `drift_before` is that of the previous half [m]
    Column<Real> still_time;
    Column<Real> drift, drift_before;
    // Largest distance of the shape from that at still_position in this half [m]; and that of the previous half if it
    // only grew there, else 0 [m]
    Column<Real> shape_drift, creep_before;
    Column<Real> max_speed;  // greatest node speed of this step [m/s]
    Column<MovingFrame> frame;
    // Quantities in the frame of the body:
    Column<Real> frame_speed;   // greatest node speed of this step [m/s]
    Column<Real> displacement;  // greatest distance of a node from its displacement origin [m]
    // Travel bound: since any earlier time no node has moved further than the growth of `travel` plus twice the
    // displacement at that time [m]
    Column<Real> travel;
    Column<Real> uninverted_until;  // no tetrahedron turns inside out or back while travel is below this [m]

    /// The only list of columns. Derived by Model::rebuild_outlines: triangles to bvh_leaves.
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
