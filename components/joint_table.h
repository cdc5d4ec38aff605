// Joints of rigid bodies: one row per joint, and in each step blocks of three constraint equations
// (docs/methods/joints.md).
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "components/column.h"
#include "components/column_role.h"
#include "components/joint_kind.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Drive of the axis of a hinge or a slider: none, towards a speed, or towards a position.
enum class JointDrive : std::uint8_t { none, speed, position };
template <>
inline constexpr std::uint64_t value_count<JointDrive> = 3;

struct JointMotorRow {
    Real target = 0;      // speed [rad/s or m/s] or position [rad or m]
    Real most = 0;        // largest torque or force [N m or N]
    Real most_speed = 0;  // largest speed on the way to a position [rad/s or m/s]

    bool operator==(const JointMotorRow&) const = default;
};
template <>
struct NumbersOf<JointMotorRow> : Reals<3> {};

/// Frame of a joint on a body or in the world: its origin, and its axis as the third axis of the frame.
struct JointFrame {
    Vec3 point = Vec3::Zero();  // in the frame of the mesh, or of the world [m]
    Mat3 axes = Mat3::Identity();
};
template <>
struct NumbersOf<JointFrame> : Reals<12> {};

/// The relative coordinate is the angle of a hinge [rad] or the displacement of a slider [m], zero when the joint was
/// made.
struct JointTable {
    Column<std::uint32_t> slot;
    Column<JointKind> kind;
    Column<JointDrive> drive;
    Column<std::uint8_t> parts;  // 1: the joint has switched off collisions between its bodies
    Column<Index> first;         // row of BodyTable
    Column<Index> second;        // row of BodyTable, or no_index: the world
    Column<JointFrame> first_frame, second_frame;
    Column<Real> lower, upper;  // limits of the coordinate; infinite: no limit
    Column<JointMotorRow> motor;
    // Values of the last step: the coordinate at its start, whole turns included, and the impulses.
    Column<Real> coordinate;
    Column<Vec3> impulse, moment;  // on the first body, in the frame on the second [N s, N m s]
    Column<Real> step;             // time for which the impulses acted; 0 before the first step [s]

    std::size_t size() const { return slot.size(); }

    /// The only list of columns.
    void for_each_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("kind", kind, ColumnRole::state);
        visit("drive", drive, ColumnRole::state);
        visit("parts", parts, ColumnRole::state);
        visit("first", first, ColumnRole::body);
        visit("second", second, ColumnRole::body);
        visit("first_frame", first_frame, ColumnRole::state);
        visit("second_frame", second_frame, ColumnRole::state);
        visit("lower", lower, ColumnRole::state);
        visit("upper", upper, ColumnRole::state);
        visit("motor", motor, ColumnRole::state);
        visit("coordinate", coordinate, ColumnRole::state);
        visit("impulse", impulse, ColumnRole::state);
        visit("moment", moment, ColumnRole::state);
        visit("step", step, ColumnRole::state);
    }
};

/// Law of the third row of a block: how its coordinate may move.
struct AxisLaw {
    bool locked = true;  // locked like the other two rows
    Real coordinate = 0;
    Real lower = -std::numeric_limits<Real>::infinity(), upper = std::numeric_limits<Real>::infinity();
    JointDrive drive = JointDrive::none;
    JointMotorRow motor{};
    Real most_impulse = 0;  // largest impulse of the motor in this step [N s or N m s]
};

/// Three constraint rows of one joint in this step, on the velocities at its point or on the angular velocities.
/// Impulses act on the first body.
struct JointBlock {
    Index joint;                    // row of JointTable
    bool turning;                   // the rows constrain angular velocities
    Index first, second;            // rows of RigidBodyTable; no_index: the world
    Index first_node, second_node;  // first node of the body if impulses can move it, else no_index
    Vec3 point;                     // [m]
    Mat3 frame;                     // columns: the directions of the rows
    Vec3 error;                     // along the locked rows [m or rad]
    AxisLaw axis;
};

/// In joint order; blocks of one joint are adjacent.
struct JointBlockTable {
    Column<JointBlock> block;
    Column<Vec3> impulse;          // by row of the block; before the solve: the warm start [N s or N m s]
    Column<Real> coordinate;       // by row of JointTable
    Column<std::uint8_t> resting;  // by row of JointTable: its bodies are at rest, and it keeps its last impulse

    std::size_t size() const { return block.size(); }
    void for_each_column(auto&& visit) {
        visit("block", block, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("coordinate", coordinate, ColumnRole::scratch);
        visit("resting", resting, ColumnRole::scratch);
    }
};

}  // namespace skerry
