// One row per collider: a rigid shape that stands still or moves by a script, which may be changed between steps.
#pragma once

#include <cstdint>

#include "components/collision_filter.h"
#include "components/column.h"
#include "components/column_role.h"
#include "components/material_table.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

enum class ColliderShape : std::uint8_t { plane, sphere, box, capsule, cylinder, bucket, mesh };
template <>
inline constexpr std::uint64_t value_count<ColliderShape> = 7;

/// A shape in its own frame, centred at the origin; axes along z.
struct ColliderGeometry {
    ColliderShape shape;
    // m. plane: unused (normal +z). sphere: (radius, -, -). box: half extents. capsule: (radius, half length of the
    // segment, -). cylinder: (radius, half height, -). bucket: (inner radius, inner height, wall): floor at z = 0, open
    // above, material of thickness `wall` below and around. mesh: unused, see BodyTable::collider
    Vec3 size;
};
template <>
struct MembersOf<ColliderGeometry> {
    static std::span<const Member> list();
};

/// Where a rigid shape is and how it moves during this step.
struct RigidMotion {
    Vec3 position;          // m
    Mat3 rotation;          // shape frame to world
    Vec3 velocity;          // m/s, of the origin, mean of the step
    Vec3 angular_velocity;  // rad/s, mean of the step

    bool stands_still() const { return velocity.isZero(0) && angular_velocity.isZero(0); }
};
template <>
struct NumbersOf<RigidMotion> : Reals<18> {};

/// One key of a script; between keys position is linear and rotation turns about a fixed axis.
struct Keyframe {
    Real time;      // s
    Vec3 position;  // m
    Vec3 rotation;  // rad, axis times angle
};
template <>
struct NumbersOf<Keyframe> : Reals<7> {};

/// How a collider or an attachment moves.
struct MotionScript {
    Vec3 velocity;          // m/s, when there are no keys
    Vec3 angular_velocity;  // rad/s, when there are no keys
    Index key_begin;        // range in ColliderTable::keyframe or AttachmentTable::keyframe
    Index key_end;
    Real start = 0;  // s, when it was at its initial pose, when there are no keys
};
template <>
struct MembersOf<MotionScript> {
    static std::span<const Member> list();
};

struct ColliderTable {
    Column<std::uint32_t> slot;
    Column<ColliderGeometry> geometry;
    Column<RigidMotion> motion;   // of this step, by move_colliders
    Column<RigidMotion> initial;  // at the start of the script
    Column<MotionScript> script;
    Column<Keyframe> keyframe;          // of all colliders, by script range
    Column<SurfaceProperties> surface;  // a property below zero: the contact takes the body's
    Column<CollisionFilter> filter;     // whom it touches
    Column<Index> body;                 // row of the kinematic body of a mesh collider, else no_index
    Column<Real> travel;                // m, how far any of its points near a body can have moved, as BodyTable::travel

    /// All columns that have one row per collider; `keyframe` is ragged and is visited on its own by for_each_column.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("geometry", geometry, ColumnRole::state);
        visit("motion", motion, ColumnRole::memory);
        visit("initial", initial, ColumnRole::state);
        visit("script", script, ColumnRole::link);
        visit("surface", surface, ColumnRole::state);
        visit("filter", filter, ColumnRole::link);
        visit("body", body, ColumnRole::link);
        visit("travel", travel, ColumnRole::memory);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("keyframe", keyframe, ColumnRole::state);
    }
};

}  // namespace skerry
