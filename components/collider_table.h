// One row per collider: a rigid shape that stands still or moves by a script. Scripts may be changed between steps.
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

/// A collider shape in its own frame: centred at the origin, with its axis along z.
struct ColliderGeometry {
    ColliderShape shape;
    // Dimensions [m]. plane: unused (normal +z). sphere: (radius, -, -). box: half extents. capsule: (radius, half
    // length of the segment, -). cylinder: (radius, half height, -). bucket: (inner radius, inner height, wall): floor
    // at z = 0, open above, material of thickness `wall` below and around. mesh: unused, see BodyTable::collider.
    Vec3 size;
};
template <>
struct MembersOf<ColliderGeometry> {
    static std::span<const Member> list();
};

/// Pose of a rigid shape and its motion during this step.
struct RigidMotion {
    Vec3 position;          // [m]
    Mat3 rotation;          // maps the shape frame to the world
    Vec3 velocity;          // velocity of the origin, mean over the step [m/s]
    Vec3 angular_velocity;  // angular velocity, mean over the step [rad/s]

    bool stands_still() const { return velocity.isZero(0) && angular_velocity.isZero(0); }
};
template <>
struct NumbersOf<RigidMotion> : Reals<18> {};

/// Keyframe of a script. Between keyframes the position is interpolated linearly, and the rotation turns about a fixed
/// axis.
struct Keyframe {
    Real time;      // [s]
    Vec3 position;  // [m]
    Vec3 rotation;  // rotation vector: axis times angle [rad]
};
template <>
struct NumbersOf<Keyframe> : Reals<7> {};

/// Scripted motion of a collider or an attachment.
struct MotionScript {
    Vec3 velocity;          // constant velocity if the script has no keyframes [m/s]
    Vec3 angular_velocity;  // constant angular velocity if the script has no keyframes [rad/s]
    Index key_begin;        // range of keyframes in ColliderTable::keyframe or AttachmentTable::keyframe
    Index key_end;
    Real start = 0;  // time at which the initial pose holds; used without keyframes [s]
};
template <>
struct MembersOf<MotionScript> {
    static std::span<const Member> list();
};

struct ColliderTable {
    Column<std::uint32_t> slot;
    Column<ColliderGeometry> geometry;
    Column<RigidMotion> motion;   // pose and motion in this step, written by move_colliders
    Column<RigidMotion> initial;  // pose and motion at the start of the script
    Column<MotionScript> script;
    Column<Keyframe> keyframe;          // keyframes of all colliders; each script has a range of them
    Column<SurfaceProperties> surface;  // surface properties; where negative, those of the touching body are used
    Column<CollisionFilter> filter;     // groups that the collider belongs to and collides with
    Column<Index> body;                 // row of BodyTable: kinematic body of a mesh collider, else no_index
    // Bound on the motion of the collider's points near a body, similar to BodyTable::travel [m].
    Column<Real> travel;

    /// Visits the columns with one row per collider. `keyframe` is not one of them; only for_each_column visits it.
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
