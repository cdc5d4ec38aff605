// One row per collider: a rigid shape that does not move or follows a script. The user may change scripts between
// steps.
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

/// A collider shape in its own frame. Its axis is the z axis. All shapes but bucket and mesh are centred at the origin.
struct ColliderGeometry {
    ColliderShape shape;
    // Dimensions of the shape [m]:
    // - plane: unused, the normal is +z
    // - sphere: (radius, -, -)
    // - box: half extents
    // - capsule: (radius, half length of the segment, -)
    // - cylinder: (radius, half height, -)
    // - bucket: (inner radius, inner height, thickness of wall and floor); the inner side of the floor is at z = 0, the
    //   top is open
    // - mesh: unused, see BodyTable::collider
    Vec3 size;
};
template <>
struct MembersOf<ColliderGeometry> {
    static std::span<const Member> list();
};

/// Pose of a rigid shape at the start of this step, and its mean motion during the step.
struct RigidMotion {
    Vec3 position;          // [m]
    Mat3 rotation;          // maps the shape frame to the world
    Vec3 velocity;          // mean velocity of the origin over the step [m/s]
    Vec3 angular_velocity;  // mean angular velocity over the step [rad/s]

    bool stands_still() const { return velocity.isZero(0) && angular_velocity.isZero(0); }
};
template <>
struct NumbersOf<RigidMotion> : Reals<18> {};

/// Keyframe of a script. Between two keyframes the position is interpolated linearly, and the shape rotates about a
/// fixed axis at constant speed.
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
    // the keyframes are rows key_begin .. key_end - 1 of ColliderTable::keyframe or AttachmentTable::keyframe
    Index key_begin;
    Index key_end;
    Real start = 0;  // time at which the shape has its initial pose; only used without keyframes [s]
};
template <>
struct MembersOf<MotionScript> {
    static std::span<const Member> list();
};

struct ColliderTable {
    Column<std::uint32_t> slot;
    Column<ColliderGeometry> geometry;
    Column<RigidMotion> motion;   // pose and motion of the collider in this step, written by move_colliders
    Column<RigidMotion> initial;  // pose and motion of the collider at the start of the script
    Column<MotionScript> script;
    Column<Keyframe> keyframe;  // keyframes of all colliders; each script refers to a range of these rows
    // surface properties of the collider; a negative property is replaced by that of the collider's material or,
    // without a material, by that of the touching body
    Column<SurfaceProperties> surface;
    Column<Index> material;          // row of MaterialTable: material of the surface, or no_index
    Column<CollisionFilter> filter;  // groups that the collider belongs to, and groups that it collides with
    Column<Index> body;              // row of BodyTable: kinematic body of a mesh collider, else no_index
    // Counter that bounds the motion of the collider: in any time interval, its points near bodies move no further than
    // the counter increases [m]. Other points do not count, because a rotating plane moves arbitrarily fast far from
    // its axis.
    Column<Real> travel;

    /// Visits the columns with one row per collider. The column `keyframe` is visited by for_each_column only.
    void for_each_row_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("geometry", geometry, ColumnRole::state);
        visit("motion", motion, ColumnRole::memory);
        visit("initial", initial, ColumnRole::state);
        visit("script", script, ColumnRole::link);
        visit("surface", surface, ColumnRole::state);
        visit("material", material, ColumnRole::link);
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
