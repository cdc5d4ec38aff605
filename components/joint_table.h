// Joints of rigid bodies: one row per joint, and in each step rows of equations three by three
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

/// What drives the axis of a hinge or a slider: nothing, towards a speed, or towards a position.
enum class JointDrive : std::uint8_t { none, speed, position };
template <>
inline constexpr std::uint64_t value_count<JointDrive> = 3;

struct JointMotorRow {
    Real target = 0;      // rad/s or m/s; rad or m
    Real most = 0;        // N m or N
    Real most_speed = 0;  // rad/s or m/s, on the way to a position

    bool operator==(const JointMotorRow&) const = default;
};
template <>
struct NumbersOf<JointMotorRow> : Reals<3> {};

/// Where a joint sits on a body, or in the world: its origin, and its axis as the third of the frame.
struct JointFrame {
    Vec3 point = Vec3::Zero();  // m, in the frame of the mesh, or the world
    Mat3 axes = Mat3::Identity();
};
template <>
struct NumbersOf<JointFrame> : Reals<12> {};

/// The relative coordinate is the angle of a hinge (rad) or the way of a slider (m), zero where the joint was made.
struct JointTable {
    Column<std::uint32_t> slot;
    Column<JointKind> kind;
    Column<JointDrive> drive;
    Column<std::uint8_t> parts;  // the joint has switched off collisions of its bodies
    Column<Index> first;         // row of BodyTable
    Column<Index> second;        // row of BodyTable, or no_index: the world
    Column<JointFrame> first_frame, second_frame;
    Column<Real> lower, upper;  // limits of the coordinate; infinite: none
    Column<JointMotorRow> motor;
    // Of the last step: the coordinate at its start, whole turns counted, and
    Column<Real> coordinate;
    Column<Vec3> impulse, moment;  // N s, N m s, on the first body, in the frame on the second
    Column<Real> step;             // s, 0 before the first

    std::size_t size() const { return slot.size(); }

    /// The only list of columns.
    void for_each_column(auto&& visit) {
        visit("slot", slot, ColumnRole::state);
        visit("kind", kind, ColumnRole::state);
        visit("drive", drive, ColumnRole::state);
        visit("parts", parts, ColumnRole::state);
        visit("first", first, ColumnRole::link);
        visit("second", second, ColumnRole::link);
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

/// What the third row of a block lets its coordinate do.
struct AxisLaw {
    bool locked = true;  // as the other two
    Real coordinate = 0;
    Real lower = -std::numeric_limits<Real>::infinity(), upper = std::numeric_limits<Real>::infinity();
    JointDrive drive = JointDrive::none;
    JointMotorRow motor{};
    Real most_impulse = 0;  // N s or N m s, of the motor in this step
};

/// Three rows of one joint in this step: of the velocities at its point, or of the spins. Impulses are on the first
/// body.
struct JointBlock {
    Index joint;                    // row of JointTable
    bool turning;                   // of spins
    Index first, second;            // rows of RigidBodyTable; no_index: the world
    Index first_node, second_node;  // its first node, where impulses can move it, else no_index
    Vec3 point;                     // m
    Mat3 frame;                     // columns: the directions of the rows
    Vec3 error;                     // m or rad, along the rows that are locked
    AxisLaw axis;
};

/// In the order of the joints; those of a joint stand together.
struct JointBlockTable {
    Column<JointBlock> block;
    Column<Vec3> impulse;          // N s or N m s, by row of the block; before the solve: the warm start
    Column<Real> coordinate;       // by row of JointTable
    Column<std::uint8_t> resting;  // by row of JointTable: what it joins rests, and it gives what it gave

    std::size_t size() const { return block.size(); }
    void for_each_column(auto&& visit) {
        visit("block", block, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("coordinate", coordinate, ColumnRole::scratch);
        visit("resting", resting, ColumnRole::scratch);
    }
};

}  // namespace skerry
