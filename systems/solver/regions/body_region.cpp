#include "systems/solver/regions/body_region.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace skerry {
namespace {

/// Adds the impulse of a contact to its nodes on implicit bodies, according to their weights.
void write_deforming(const RegionStage& stage, const BodyMemory& memory, std::size_t i) {
    if (!stage.inputs.implicit.any()) return;
    const LumpedContact& contact = memory.contact[i];
    for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a) {
        const Index node = memory.node[static_cast<std::size_t>(contact.node[a])];
        const Index row = stage.inputs.implicit.row(node, stage.inputs.rigid.nodes);
        if (row != no_index)
            stage.out.deforming_impulse[static_cast<std::size_t>(row)] +=
                contact.weight[a] * memory.impulse[i].head<3>();
    }
}

/// Adds the impulse and moment of a contact or a joint to its rigid bodies.
void write_to_bodies(const RegionStage& stage, const RigidPart& part, const Vec4& impulse) {
    for (Index k = 0; k < part.term_count; ++k) {
        const RigidTerm& term = part.term[static_cast<std::size_t>(k)];
        const auto r = static_cast<std::size_t>(term.row);
        stage.out.contact_impulse[r] += term.weight * impulse.head<3>();
        stage.out.contact_moment[r] += cross(term.arm, impulse).head<3>() + term.spin_coefficient * impulse.head<3>();
    }
}

}  // namespace

void BodyRegion::take_joint_impulses(const RegionStage& stage) const {
    for (std::size_t k = 0; k < joint.size(); ++k) {
        const std::size_t i = row.size() + k;
        const Vec3& last = stage.out.joint_impulse[static_cast<std::size_t>(joint[k])];
        memory.impulse[i] = times(memory.part[i].frame, padded(last));
    }
    for (const Index cable_row : cable) take_cable_impulses(stage, cable_row, memory);
}

void BodyRegion::hold_joints(const RegionStage& stage, BodyOperator& op, RegionOutcome& outcome) const {
    if (joint.empty() || outcome.status == RegionStatus::not_finite) return;
    Real correction = 0;  // squared energy norm of the correction [J]
    for (std::size_t k = 0; k < joint.size(); ++k) {
        const JointBlock& block = stage.inputs.joints[static_cast<std::size_t>(joint[k])];
        if (block.mimic.coefficient == 0)
            correction += correct_joint(stage, block, memory.velocity, loaded_joint(stage, k));
    }
    const Real small = tolerance * scale;
    if (correction <= small * small && !stage.settings.fixed_iterations) return;
    const Index before = outcome.iterations;
    outcome = sweep_region(stage, *this, op);
    outcome.iterations += before;
}

void BodyRegion::write_contact(const RegionStage& stage, std::size_t i) const {
    write_stencil(stage, stage.inputs.stencil[static_cast<std::size_t>(row[i])], i);
}

void BodyRegion::write_stencil(const RegionStage& stage, const Stencil& stencil, std::size_t i) const {
    const RigidInputs& bodies = stage.inputs.rigid;
    write_to_bodies(stage, memory.part[i], memory.impulse[i]);
    for (std::size_t a = 0; a < 4; ++a) {
        const Index node = stencil.node[a];
        const bool moves = stencil.weight[a] != 0 && stage.inputs.inverse_mass[static_cast<std::size_t>(node)] > 0;
        const Index body = moves ? bodies.nodes.row(node) : no_index;
        if (body == no_index) continue;
        const auto slot = static_cast<std::size_t>(2 * (std::find(rigid.begin(), rigid.end(), body) - rigid.begin()));
        const Vec3 arm =
            bodies.position[static_cast<std::size_t>(node)] - bodies.center[static_cast<std::size_t>(body)];
        Vec3& next = stage.out.velocity_next[static_cast<std::size_t>(node)];
        next = memory.velocity[slot].head<3>() + memory.velocity[slot + 1].head<3>().cross(arm);
        if (stage.inputs.implicit.row(node, bodies.nodes) != no_index)
            next += memory.velocity[static_cast<std::size_t>(stage.memory.node_index[static_cast<std::size_t>(node)])]
                        .head<3>();
    }
    write_deforming(stage, memory, i);
}

void BodyRegion::write_joints(const RegionStage& stage) const {
    for (std::size_t k = 0; k < joint.size(); ++k) {
        const std::size_t i = row.size() + k;
        const RigidPart& part = memory.part[i];
        write_to_bodies(stage, part, memory.impulse[i]);
        const auto block = static_cast<std::size_t>(joint[k]);
        const Vec3 impulse = matrix_of(part.frame).transpose() * memory.impulse[i].head<3>();
        stage.out.joint_impulse[block] = impulse;
        const LoadedJoint loaded = loaded_joint(stage, k);
        if (!loaded.law.axis_free) continue;
        const Vec4 u = add_rigid_velocities(part, memory.velocity.data(), loaded.contact.offset);
        stage.out.axis_impulse[block] =
            parts_of(loaded.law.axis, loaded.law.axis_mobility, part.frame[2].dot(u), impulse.z());
    }
    std::size_t i = row.size() + joint.size();
    for (const Index cable_row : cable) {
        for (const Stencil& stencil : rows_of(stage.inputs.cables.stencil,
                                              stage.inputs.cables.block[static_cast<std::size_t>(cable_row)].points))
            write_stencil(stage, stencil, i++);
        write_cable(stage, cable_row, memory);
    }
}

void BodyRegion::write_body_push(const RegionStage& stage) const {
    for (std::size_t k = 0; k < rigid.size(); ++k) {
        const auto r = static_cast<std::size_t>(rigid[k]);
        stage.out.push_velocity[r] = memory.scratch[2 * k].head<3>();
        stage.out.push_spin[r] = memory.scratch[2 * k + 1].head<3>();
    }
}

Real BodyRegion::push_work(const RegionStage& stage) const {
    const RigidInputs& bodies = stage.inputs.rigid;
    Real work = push_work_of_nodes(stage, memory, false);
    for (std::size_t k = 0; k < rigid.size(); ++k) {
        const auto r = static_cast<std::size_t>(rigid[k]);
        work -= bodies.kick[r].dot(memory.scratch[2 * k].head<3>()) +
                bodies.spins.moment_kick[r].dot(memory.scratch[2 * k + 1].head<3>());
    }
    return work;
}

RegionOutcome solve_bodies(const RegionStage& stage, const RegionRows& rows, Index number, Index base) {
    return solve_loaded(stage, load_body_region(stage, rows, number, base));
}

}  // namespace skerry
