// One row per body: ranges into the other tables, and its state as a whole.
#pragma once

#include <cstdint>

#include "components/bvh_table.h"
#include "components/column.h"
#include "components/step_levels.h"
#include "components/types.h"

namespace skerry {

/// Rows begin .. end - 1 of some table.
struct Range {
    Index begin = 0;
    Index end = 0;

    Index size() const { return end - begin; }
    bool operator==(const Range&) const = default;
};

enum class BodyKind : std::uint8_t {
    deformable,
    kinematic,  // a mesh collider: nodes without elements, moved by its collider
};

struct BodyTable {
    Column<std::uint32_t> slot;  // handle slot of the body, or of the collider that a kinematic body belongs to
    Column<BodyKind> kind;
    Column<std::uint8_t> self_contact;
    Column<Index> material;  // row of MaterialTable; no_index for a kinematic body
    Column<Index> collider;  // row of ColliderTable of a kinematic body, else no_index
    Column<Range> nodes;
    Column<Range> node_blocks;
    Column<Range> blocks;  // of ElementBlockTable
    Column<Range> triangles;
    Column<Range> edges;
    Column<Range> vertices;
    Column<Range> bvh_nodes;
    Column<Range> bvh_leaves;
    Column<Index> element_count;
    Column<Index> pinned_count;     // nodes without freedom
    Column<Real> contact_distance;  // m, thickness of the contact shell; two bodies keep the mean of theirs
    Column<Real> mean_edge;         // m, of the surface at rest
    Column<Real> min_altitude;      // m, of the elements at rest
    Column<Real> rest_step;         // s, stable step of the rest shape
    Column<Real> stable_step;       // s, as last watched
    Column<std::uint8_t> level;     // of the whole body in the present cycle of steps: its own steps are 2^level steps long
    Column<std::array<Index, element_level_count>> level_count;  // elements of each level, within the body
    Column<LevelMask> due;                                       // levels of elements, within the body, that get an impulse in this step
    Column<std::uint8_t> asleep;                                 // at rest: left out of the step until something touches it
    Column<Real> calm;                                           // s, for how long no node has been as fast as sleep_speed
    Column<Real> max_speed;                                      // m/s, of this step's motion
    Column<Real> drift;                                          // m, greatest distance of a node from its drift origin
    Column<Real> travel;       // m: since any earlier time no node has come further than the growth of travel plus twice the drift then
    Column<Real> sound_until;  // m: the least of the body's element blocks

    void for_each_column(auto&& visit) {
        visit("slot", slot);
        visit("kind", kind);
        visit("self_contact", self_contact);
        visit("material", material);
        visit("collider", collider);
        visit("nodes", nodes);
        visit("node_blocks", node_blocks);
        visit("blocks", blocks);
        visit("triangles", triangles);
        visit("edges", edges);
        visit("vertices", vertices);
        visit("bvh_nodes", bvh_nodes);
        visit("bvh_leaves", bvh_leaves);
        visit("element_count", element_count);
        visit("pinned_count", pinned_count);
        visit("contact_distance", contact_distance);
        visit("mean_edge", mean_edge);
        visit("min_altitude", min_altitude);
        visit("rest_step", rest_step);
        visit("stable_step", stable_step);
        visit("level", level);
        visit("level_count", level_count);
        visit("due", due);
        visit("asleep", asleep);
        visit("calm", calm);
        visit("max_speed", max_speed);
        visit("drift", drift);
        visit("travel", travel);
        visit("sound_until", sound_until);
    }
};

}  // namespace skerry
