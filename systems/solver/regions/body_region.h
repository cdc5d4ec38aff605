// Regions that need the operator with 3x3 blocks: they touch rigid or implicit bodies, have a cable, or have friction
// that depends on the direction (needs_blocks in region_blocks.h; docs/methods/rigid_bodies.md 3).
#pragma once

#include "systems/solver/operators/body_operator.h"
#include "systems/solver/regions/cable_rows.h"
#include "systems/solver/regions/joint_rows.h"
#include "systems/solver/regions/life_cycle.h"
#include "systems/solver/regions/pushed_bodies.h"

namespace skerry {

/// A region that BodyOperator solves.
/// - Velocity rows: two per rigid or implicit body (velocity, angular velocity), then the nodes of implicit bodies that
///   have contacts, then nodes of clusters, then other nodes
/// - Columns by contact: contacts, then rows of joints, then points of cables
struct BodyRegion : LoadedRegion<ThroughGroups, BodyMemory> {
    std::span<const Index> joint;  // rows of JointBlockTable
    std::span<const Index> cable;  // indices of the cables that the region solves
    std::span<const Index> rigid;  // rows of RigidBodyTable
    bool has_axes = false;         // true if the friction of a contact depends on the direction

    // The next functions replace those of LoadedRegion (life_cycle.h).
    bool moves_node(const RegionStage& stage, std::size_t n) const {
        // False for the rows of rigid bodies, which belong to no node, and for nodes of implicit bodies, whose
        // velocities write_contact computes from the motion of the frame and the deformation.
        return memory.node[n] != no_index &&
               stage.inputs.implicit.row(memory.node[n], stage.inputs.rigid.nodes) == no_index;
    }
    /// Method of the settings if it supports all rows of the region, otherwise `ags`. For regions with joints or cables
    /// this is always `ags`. Regions with friction that depends on the direction support only `ags` and `automatic`.
    SolverMethod method(const SolverSettings& settings) const {
        const bool any = joint.empty() && cable.empty() && (!has_axes || settings.method == SolverMethod::automatic);
        return any ? settings.method : SolverMethod::ags;
    }
    void take_joint_impulses(const RegionStage& stage) const;
    /// Corrects the offsets of the joint rows so that the joints hold at the end of the step. Sweeps again if the
    /// correction exceeds the tolerance (docs/methods/joints.md 2).
    void hold_joints(const RegionStage& stage, BodyOperator& op, RegionOutcome& outcome) const;
    void write_contact(const RegionStage& stage, std::size_t i) const;
    /// Adds the impulse at index `i` of memory.impulse to the rigid and implicit bodies of the nodes of `stencil`, and
    /// writes the velocities of these nodes. The stencil is that of a contact or of a cable point.
    void write_stencil(const RegionStage& stage, const Stencil& stencil, std::size_t i) const;
    void write_joints(const RegionStage& stage) const;
    void write_body_push(const RegionStage& stage) const;
    PushedBodies pushed(const RegionStage& stage, const BodyOperator& op) const {
        return {stage, row, rigid, memory, op};
    }
    Real push_work(const RegionStage& stage) const;

    LoadedJoint loaded_joint(const RegionStage& stage, std::size_t k) const {
        RegionMemory& data = stage.memory;
        const std::size_t at = static_cast<std::size_t>(base) + row.size() + k;
        return {data.contact[at], data.rigid_part[at], data.joint_law[at - data.contact_rows]};
    }
};

inline BodyOperator operator_of(const RegionStage& stage, const BodyRegion& region) {
    return {region.memory,    stage.settings.friction, region.scale,
            region.traversal, stage.memory.newton,     stage.memory.runs};
}

/// Contents of a region: rows of ContactTable, rows of JointBlockTable, and indices in SolvedCables::block.
struct RegionRows {
    std::span<const Index> contact, joint, cable;
};

/// Loads a region for which needs_blocks() is true. Sets its impulses to zero.
BodyRegion load_body_region(const RegionStage& stage, const RegionRows& rows, Index number, Index base);

/// Solves a region for which needs_blocks() is true, in one thread.
RegionOutcome solve_bodies(const RegionStage& stage, const RegionRows& rows, Index number, Index base);

}  // namespace skerry
