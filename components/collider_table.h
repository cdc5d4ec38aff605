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

/// A shape in its own frame, centred at the origin; axes along z.
struct ColliderGeometry {
    ColliderShape shape;
    // Dimensions [m]. plane: unused (normal +z). sphere: (radius, -, -). box: half extents. capsule: (radius, half
    // length of the segment, -). cylinder: (radius, half height, -). bucket: (inner radius, inner height, wall): floor
    // at z = 0, open above, material of thickness `wall` below and around. mesh: unused, see BodyTable::collider
    Vec3 size;
};
template <>
struct MembersOf<ColliderGeometry> {
    static std::span<const Member> list();
};

/// Pose of a rigid shape and its motion during this step.
struct RigidMotion {
    Vec3 position;          // [m]
    Mat3 rotation;          // from the shape frame to the world
    Vec3 velocity;          // of the origin, mean over the step [m/s]
    Vec3 angular_velocity;  // mean over the step [rad/s]

    bool stands_still() const { return velocity.isZero(0) && angular_velocity.isZero(0); }
};
template <>
struct NumbersOf<RigidMotion> : Reals<18> {};

/// Keyframe of a script. Between keys the position is linear and the rotation turns about a fixed axis.
struct Keyframe {
    Real time;      // [s]
    Vec3 position;  // [m]
    Vec3 rotation;  // axis times angle [rad]
};
template <>
struct NumbersOf<Keyframe> : Reals<7> {};

/// Motion of a collider or an attachment.
struct MotionScript {
    Vec3 velocity;          // used without keys [m/s]
    Vec3 angular_velocity;  // used without keys [rad/s]
    Index key_begin;        // range in ColliderTable::keyframe or AttachmentTable::keyframe
    Index key_end;
    Real start = 0;  // time of its initial pose, used without keys [s]
};
template <>
struct MembersOf<MotionScript> {
    static std::span<const Member> list();
};

struct ColliderTable {
    Column<std::uint32_t> slot;
    Column<ColliderGeometry> geometry;
    Column<RigidMotion> motion;   // in this step, written by move_colliders
    Column<RigidMotion> initial;  // at the start of the script
    Column<MotionScript> script;
    Column<Keyframe> keyframe;          // for all colliders; each script has a range
    Column<SurfaceProperties> surface;  // the body's value replaces a negative property
    Column<CollisionFilter> filter;     // groups it belongs to and collides with
    Column<Index> body;                 // row of the kinematic body of a mesh collider, else no_index
    Column<Real> travel;                // bound on the motion of its points near a body, as BodyTable::travel [m]

    /// All columns with one row per collider. `keyframe` has none and is visited by for_each_column only.
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
