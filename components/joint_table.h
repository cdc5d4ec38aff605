// Joints of rigid bodies: one row per joint, and the blocks of constraint equations that each step computes. A block
// has three equations (docs/methods/joints.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/column_role.h"
#include "components/joint_kind.h"
#include "components/key_lists.h"
#include "components/row_type.h"
#include "components/types.h"

namespace skerry {

/// Drive of the motion of a hinge or slider along its axis: no drive, drive to a target speed, or drive to a target
/// position.
enum class JointDrive : std::uint8_t { none, speed, position };
template <>
inline constexpr std::uint64_t value_count<JointDrive> = 3;

struct JointMotorRow {
    Real target = 0;      // target speed [rad/s or m/s] or target position [rad or m]
    Real most = 0;        // greatest torque or force of the motor [N m or N]
    Real most_speed = 0;  // greatest speed of the motion to a target position [rad/s or m/s]

    bool operator==(const JointMotorRow&) const = default;
};
template <>
struct NumbersOf<JointMotorRow> : Reals<3> {};

/// Passive forces along the axis of a hinge or slider.
struct JointPassiveRow {
    Real stiffness = 0;  // stiffness of the spring [N m/rad or N/m]
    Real rest = 0;       // joint coordinate at which the spring exerts no force [rad or m]
    Real damping = 0;    // [N m s/rad or N s/m]
    Real friction = 0;   // greatest moment or force of dry friction [N m or N]

    bool operator==(const JointPassiveRow&) const = default;
};
template <>
struct NumbersOf<JointPassiveRow> : Reals<4> {};

/// Linear relation between the coordinates of two joints: q = ratio q_leader + offset.
struct MimicRow {
    Real ratio = 1;   // unit: none, or [m/rad] or [rad/m] if a hinge and a slider are coupled
    Real offset = 0;  // [rad or m]

    bool operator==(const MimicRow&) const = default;
};
template <>
struct NumbersOf<MimicRow> : Reals<2> {};

/// Impulses along the joint axis [N s or N m s]. `motor`: of the motor. `passive`: of spring, damper and friction
/// together.
struct AxisImpulses {
    Real motor = 0, passive = 0;
};
template <>
struct NumbersOf<AxisImpulses> : Reals<2> {};

/// Frame of a joint, fixed to a body or to the world. The third axis of the frame is the axis of the joint.
struct JointFrame {
    Vec3 point = Vec3::Zero();  // origin of the joint frame, in the frame of the mesh or of the world [m]
    Mat3 axes = Mat3::Identity();
};
template <>
struct NumbersOf<JointFrame> : Reals<12> {};

/// One row per joint. The joint coordinate is the angle of a hinge [rad] or the displacement of a slider [m].
struct JointTable {
    Column<std::uint32_t> slot;
    Column<JointKind> kind;
    Column<JointDrive> drive;
    Column<std::uint8_t> parts;  // 1: the joint switches off collisions between its two bodies
    Column<Index> first;         // row of BodyTable
    Column<Index> second;        // row of BodyTable; no_index for the world
    Column<JointFrame> first_frame, second_frame;
    Column<Real> lower, upper;  // limits of the joint coordinate; infinite: no limit
    Column<JointMotorRow> motor;
    Column<JointPassiveRow> passive;
    Column<Range> motor_keys;  // range of rows in the column `key`; empty: the target of the motor is constant
    Column<Index> leader;      // row of the joint that this joint mimics; no_index if it mimics none
    Column<MimicRow> mimic;
    Column<Real> mimic_impulse;  // impulse of the mimic equation (MimicShare) in the last step [N s or N m s]
    // Joint coordinate at the start of the last step. The angle of a hinge includes complete revolutions.
    Column<Real> coordinate;
    Column<Real> first_coordinate;  // joint coordinate when the joint was added [rad or m]
    // Impulse and angular impulse that the joint exerted on the first body in the last step, along the axes of the
    // joint frame of the second body [N s, N m s].
    Column<Vec3> impulse, moment;
    // columns: axes of the joint frame of the second body at the start of the last step, in world coordinates
    Column<Mat3> impulse_axes;
    Column<AxisImpulses> axis_impulse;  // impulses along the joint axis in the last step
    Column<Real> step;    // time for which the impulses acted in the last step; 0 before the first step [s]
    Column<TimeKey> key;  // keys of all motors: target speeds [rad/s or m/s] or positions [rad or m]

    std::size_t size() const { return slot.size(); }

    std::span<const TimeKey> keys_of(std::size_t joint) const { return rows_of(key.span(), motor_keys[joint]); }
    void erase_keys_of(std::size_t joint) { erase_keys(motor_keys, key, joint); }
    /// Renumbers `leader` after rows were erased. `row_now`: new row by old row; no_index for erased rows.
    void rows_moved(std::span<const Index> row_now) {
        for (Index& row : leader.span())
            if (row != no_index) row = row_now[static_cast<std::size_t>(row)];
    }

    /// Visits the columns with one row per joint. The column `key` is visited by for_each_column only.
    void for_each_row_column(auto&& visit) {
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
        visit("passive", passive, ColumnRole::state);
        visit("motor_keys", motor_keys, ColumnRole::link);
        visit("leader", leader, ColumnRole::link);
        visit("mimic", mimic, ColumnRole::state);
        visit("mimic_impulse", mimic_impulse, ColumnRole::state);
        visit("coordinate", coordinate, ColumnRole::state);
        visit("first_coordinate", first_coordinate, ColumnRole::state);
        visit("impulse", impulse, ColumnRole::state);
        visit("moment", moment, ColumnRole::state);
        visit("impulse_axes", impulse_axes, ColumnRole::state);
        visit("axis_impulse", axis_impulse, ColumnRole::state);
        visit("step", step, ColumnRole::state);
    }
    void for_each_column(auto&& visit) {
        for_each_row_column(visit);
        visit("key", key, ColumnRole::state);
    }
};

/// Constraint law of the third equation of a block. The motion along the joint coordinate is either locked, or free
/// with limits, a drive and passive forces.
struct AxisLaw {
    bool locked = true;  // true: the third equation locks the motion, as the first two equations do
    Real coordinate = 0;
    Real lower = -infinity, upper = infinity;
    JointDrive drive = JointDrive::none;
    JointMotorRow motor{};  // motor in this step; for a moving target, the target position at the start of the step
    Real target_rate = 0;   // speed of the target position [rad/s or m/s]
    JointPassiveRow passive{};
    Real kick = 0;  // time for which forces act in this step [s]
};

/// Role of a block in a mimic equation (docs/methods/joints.md 5). The equation couples the velocities u and u_leader
/// along the axes of two joints, with coefficients c and c_leader: c u + c_leader u_leader = r. The rate r corrects the
/// error of the coordinates.
///
/// Two adjacent blocks store the equation: first that of the joint that mimics, then that of its leader. Only the third
/// rows of these blocks are used.
struct MimicShare {
    Real coefficient = 0;  // c of the block; 0: the block belongs to no mimic equation
    bool leads = false;    // true for the block of the leader
    // Node that represents the other block of the equation in the search for contact regions (JointBlock::own_node). It
    // serves to put both blocks into one region.
    Index other_node = no_index;
};

/// Three constraint equations of one joint in this step. They constrain either the relative velocity at the joint point
/// or the relative angular velocity of the two bodies. The impulses of the equations act on the first body, and
/// reversed on the second.
struct JointBlock {
    Index joint;          // row of JointTable
    bool turning;         // true: the equations constrain angular velocities
    Index first, second;  // rows of RigidBodyTable; no_index for the world
    // First node of each body, which represents the body in the search for contact regions; no_index if impulses cannot
    // move the body.
    Index first_node, second_node;
    Vec3 point;  // point at which the equations constrain the motion, in the world frame [m]
    Mat3 frame;  // columns: directions of the three equations
    Vec3 error;  // position error of the joint along the locked directions [m or rad]
    AxisLaw axis;
    MimicShare mimic{};
    // Vector from the joint's point to `point`, in the axes of the first joint frame [m]. Zero for a ball joint. For
    // other joints `point` is chosen near the centre of mass, where velocity and spin are coupled least (shift_of()).
    Vec3 shift = Vec3::Zero();

    /// first_node, or second_node if impulses cannot move the first body; no_index if they can move neither body.
    Index own_node() const { return first_node == no_index ? second_node : first_node; }
    /// own_node(); if this block can move no body, own_node() of the other block of its mimic equation.
    Index moving_node() const { return own_node() == no_index ? mimic.other_node : own_node(); }
    /// Calls join(a, b) for nodes a, b of bodies that the block couples. `join` must put both nodes into the same
    /// contact region.
    void join_nodes(auto&& join) const {
        if (first_node != no_index && second_node != no_index) join(first_node, second_node);
        if (own_node() != no_index && mimic.other_node != no_index) join(own_node(), mimic.other_node);
    }
};

/// Blocks of all joints in joint order, with the blocks of one joint adjacent; then the blocks of mimic equations.
struct JointBlockTable {
    Column<JointBlock> block;
    // Impulses of the three equations of each block; before the solve: the warm start [N s or N m s].
    Column<Vec3> impulse;
    Column<AxisImpulses> axis_impulse;  // by block: impulses along the joint axis
    Column<Real> coordinate;            // by row of JointTable: joint coordinate at the start of the step
    // For each row of JointTable: 1 if neither body of the joint can move, because it is asleep, held, or the world.
    // The joint then has no block and keeps its last impulse. While no body of the world sleeps, joints are not tested,
    // and all values are 0.
    Column<std::uint8_t> resting;

    std::size_t size() const { return block.size(); }
    void for_each_column(auto&& visit) {
        visit("block", block, ColumnRole::scratch);
        visit("impulse", impulse, ColumnRole::scratch);
        visit("axis_impulse", axis_impulse, ColumnRole::scratch);
        visit("coordinate", coordinate, ColumnRole::scratch);
        visit("resting", resting, ColumnRole::scratch);
    }
};

}  // namespace skerry
