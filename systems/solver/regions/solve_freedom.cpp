#include "systems/solver/regions/solve_freedom.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "systems/solver/methods/run_method.h"
#include "systems/solver/regions/joint_rows.h"
#include "systems/solver/regions/push_freedom.h"
#include "systems/solver/regions/region_blocks.h"

namespace skerry {
namespace {

const NodeClusters no_clusters;

/// Loads one region.
class Loading {
public:
    Loading(const RegionStage& stage, std::span<const Index> row, std::span<const Index> joint, Index number,
            Index base)
        : stage_(stage),
          data_(stage.memory),
          first_(static_cast<std::size_t>(base)),
          first_node_(data_.node_base[static_cast<std::size_t>(number)]),
          room_(room_of_region(stage.inputs, data_, row.size(), number)),
          node_(data_.node.span().subspan(first_node_, room_)),
          region_{.row = row,
                  .joint = joint,
                  .rigid = data_.region_rigid[static_cast<std::size_t>(number)],
                  .node = {},
                  .memory = {},
                  .walk = ThroughGroups(stage.inputs.clustered() ? *stage.inputs.clusters : no_clusters,
                                        stage.inputs.implicit, stage.inputs.rigid, node_),
                  .sums = {},
                  .scale = 0,
                  // Joints are not checked for motion, so their regions never use the tolerance of still ones.
                  .tolerance = joint.empty() ? tolerance_of(stage, row) : stage.settings.tolerance,
                  .base = base},
          number_(number) {}

    FreedomRegion load() {
        list_blocks();
        for (std::size_t i = 0; i < region_.row.size(); ++i) load_contact_at(i);
        for (std::size_t k = 0; k < region_.joint.size(); ++k) load_joint_at(k);
        set_memory();
        add_joints();
        for (std::size_t i = 0; i < region_.row.size(); ++i) {
            const LumpedContact& contact = region_.memory.contact[i];
            const Vec4 u =
                contact.offset +
                add_rigid_velocities(region_.memory.part[i], region_.memory.velocity.data(),
                                     add_node_velocities(contact, region_.memory.velocity.data(), Vec4::Zero()));
            region_.sums.add(contact, stage_.settings.friction, u);
        }
        region_.scale = error_scale(region_.sums, stage_.inputs.gravity, stage_.h, region_.tolerance);
        return region_;
    }

private:
    std::span<Vec4> velocities() const { return data_.velocity.span().subspan(first_node_, room_); }

    void list_blocks() {
        const RigidInputs& rigid = stage_.inputs.rigid;
        for (const Index body : region_.rigid) {
            const auto r = static_cast<std::size_t>(body);
            node_[count_] = node_[count_ + 1] = no_index;
            velocities()[count_] = padded(rigid.velocity(r));
            velocities()[count_ + 1] = padded(rigid.spins.kicked(r));
            count_ += 2;
        }
        if (stage_.inputs.implicit.any())
            for (const Index body : region_.rigid)
                for (const Index n : stage_.inputs.implicit.coupling->nodes[static_cast<std::size_t>(body)])
                    place_of(n);
        for (const Index c : data_.region_clusters[static_cast<std::size_t>(number_)])
            for (const Index n : stage_.inputs.clusters->nodes[static_cast<std::size_t>(c)]) place_of(n);
    }

    /// Returns the region's own row of a node.
    Index place_of(Index global) {
        Index& place = data_.place[static_cast<std::size_t>(global)];
        if (static_cast<std::size_t>(place) < count_ && node_[static_cast<std::size_t>(place)] == global) return place;
        place = static_cast<Index>(count_);
        node_[count_] = global;
        const Index row = stage_.inputs.implicit.row(global, stage_.inputs.rigid.nodes);
        velocities()[count_++] =
            padded(row == no_index ? stage_.out.velocity_next[static_cast<std::size_t>(global)]
                                   : stage_.inputs.implicit.deforming(row, stage_.inputs.rigid.nodes.row(global)));
        return place;
    }

    void load_contact_at(std::size_t i) {
        const RigidNodes& rigid = stage_.inputs.rigid.nodes;
        RigidPart& part = data_.rigid_part[first_ + i];
        part.term_count = 0;
        LumpedContact& contact = data_.contact[first_ + i];
        contact = load_contact(
            stage_.inputs, region_.row[i], stage_.out.velocity_next, stage_.settings, stage_.h,
            [&](Index node) { return place_of(node); },
            [&](Index node, Real weight) {
                const Index body = rigid.row(node);
                if (body != no_index) add_term(part, body, node, weight, i);
                return body != no_index && stage_.inputs.implicit.row(node, rigid) == no_index;
            });
        data_.impulse[first_ + i].setZero();
        find_mobility(contact, part);
    }

    JointPlaceInRegion joint_place(std::size_t k) const {
        const std::size_t at = first_ + region_.row.size() + k;
        return {data_.contact[at], data_.rigid_part[at], data_.joint_law[at - data_.contact_rows]};
    }

    void load_joint_at(std::size_t k) {
        const JointPlaceInRegion place = joint_place(k);
        load_joint(stage_, stage_.inputs.joints[static_cast<std::size_t>(region_.joint[k])], region_.rigid, place);
        data_.impulse[first_ + region_.row.size() + k].setZero();
    }

    void add_joints() {
        for (std::size_t k = 0; k < region_.joint.size(); ++k) {
            const JointPlaceInRegion place = joint_place(k);
            const Vec4 u = add_rigid_velocities(place.part, region_.memory.velocity.data(), place.contact.offset);
            add_joint(place, u, region_.sums);
        }
    }

    const Vec3& contact_normal(std::size_t i) const {
        return stage_.inputs.normal[static_cast<std::size_t>(region_.row[i])];
    }

    void add_term(RigidPart& part, Index body, Index node, Real weight, std::size_t i) {
        const RigidInputs& rigid = stage_.inputs.rigid;
        Index k = 0;
        while (k < part.term_count && part.term[static_cast<std::size_t>(k)].row != body) ++k;
        RigidTerm& term = part.term[static_cast<std::size_t>(k)];
        if (k == part.term_count) {
            ++part.term_count;
            const auto place = std::find(region_.rigid.begin(), region_.rigid.end(), body) - region_.rigid.begin();
            // A round body touches beside its core.
            const Vec3 beside = rigid.nodes.beside_core(node, weight, static_cast<std::size_t>(region_.row[i]),
                                                        contact_normal(i), stage_.inputs.touch);
            term = {.row = body, .slot = static_cast<Index>(2 * place), .arm = padded(beside), .spin_step = {}};
        }
        term.weight += weight;
        term.arm += weight * padded(rigid.position[static_cast<std::size_t>(node)] -
                                    rigid.center[static_cast<std::size_t>(body)]);
    }

    void find_mobility(LumpedContact& contact, RigidPart& part) const {
        const bool moves_nodes = contact.node_count > 0;
        Mat3 mobility = moves_nodes ? region_.walk.coupling(contact, contact) : Mat3(Mat3::Zero());
        for (Index k = 0; k < part.term_count; ++k) {
            RigidTerm& term = part.term[static_cast<std::size_t>(k)];
            const auto r = static_cast<std::size_t>(term.row);
            term.step = stage_.inputs.rigid.inverse_mass(r) > 0 ? term.weight / stage_.inputs.rigid.mass[r] : 0;
            term.spin_step =
                columns_of(stage_.inputs.rigid.spins.inverse_inertia[r] * cross_matrix(term.arm.head<3>()));
        }
        const Mat3 rigid = rigid_coupling(part, part);
        mobility += rigid;
        const Vec3 normal = contact.normal.head<3>();
        const TangentFrame tangents = tangent_frame(normal);
        part.frame = {contact.normal, padded(tangents.first), padded(tangents.second)};
        part.mobility = columns_of(mobility);
        part.along_normal = normal.dot(mobility * normal);
        if (moves_nodes && part.term_count > 0 && stage_.inputs.implicit.any())
            part.along_normal = normal.dot((region_.walk.undeformed_coupling(contact, contact) + rigid) * normal);
        part.steepest = part.term_count > 0 ? mobility.norm() : mobility(0, 0);
        if (part.term_count > 0) {
            const Mat3 frame = matrix_of(part.frame);
            part.block = prepare_block(frame.transpose() * mobility * frame);
        }
        contact.diagonal = mobility.trace() / 3;
        contact.inverse_diagonal = contact.diagonal > 0 ? 1 / contact.diagonal : 0;
    }

    std::span<const JointLaw> joint_laws() const {
        if (region_.joint.empty()) return {};
        return data_.joint_law.span().subspan(first_ + region_.row.size() - data_.contact_rows, region_.joint.size());
    }

    void set_memory() {
        const std::size_t contacts = region_.row.size() + region_.joint.size();
        region_.node = node_.first(count_);
        region_.memory = {.contact = data_.contact.span().subspan(first_, contacts),
                          .part = data_.rigid_part.span().subspan(first_, contacts),
                          .joint = joint_laws(),
                          .impulse = data_.impulse.span().subspan(first_, contacts),
                          .velocity = velocities().first(count_),
                          .free_velocity = data_.free_velocity.span().subspan(first_node_, count_),
                          .scratch = data_.scratch.span().subspan(first_node_, count_),
                          .workspace = {}};
        for (std::size_t slot = 0; slot < freedom_workspace_slots(stage_.settings.method); ++slot)
            region_.memory.workspace[slot] = data_.workspace[slot].span().subspan(first_, contacts);
        std::ranges::copy(region_.memory.velocity, data_.free_velocity.span().subspan(first_node_, count_).begin());
    }

    const RegionStage& stage_;
    RegionMemory& data_;
    std::size_t first_, first_node_, room_;
    std::span<Index> node_;
    FreedomRegion region_;
    Index number_;
    std::size_t count_ = 0;  // number of velocity rows so far
};

/// Takes the impulses of the last step and the velocities that they make.
void take_warm_impulses(const RegionStage& stage, const FreedomRegion& region, FreedomOperator& op) {
    for (std::size_t i = 0; i < region.row.size(); ++i) {
        const LumpedContact& contact = region.memory.contact[i];
        if (contact.inverse_diagonal == 0) continue;
        const Vec4 last = padded(stage.out.impulse[static_cast<std::size_t>(region.row[i])]);
        region.memory.impulse[i] = contact.friction.stick == 0 ? Vec4(contact.normal.dot(last) * contact.normal) : last;
    }
    for (std::size_t k = 0; k < region.joint.size(); ++k) {
        const std::size_t i = region.row.size() + k;
        const Vec3& last = stage.out.joint_impulse[static_cast<std::size_t>(region.joint[k])];
        region.memory.impulse[i] = times(region.memory.part[i].frame, padded(last));
    }
    op.refresh();
}

/// Variant of start_region.
bool start(const RegionStage& stage, const FreedomRegion& region, FreedomOperator& op, RegionOutcome& outcome) {
    const SolverSettings& settings = stage.settings;
    if (settings.fixed_iterations) {
        if (settings.warm_start == WarmStart::on && region.scale > 0) take_warm_impulses(stage, region, op);
        return false;
    }
    if (region.sums.separating && settings.skip_separating) {
        outcome = {.status = RegionStatus::certified, .shortcut = shortcut_separating};
        return true;
    }
    if (settings.warm_start == WarmStart::off) return false;
    take_warm_impulses(stage, region, op);
    return start_from_warm_impulse(op, settings, region.tolerance, outcome);
}

/// Corrects the joints to hold at the end of the step, and solves again if the correction exceeds the tolerance
/// (docs/methods/joints.md 2).
void hold_joints_at_end(const RegionStage& stage, const FreedomRegion& region, FreedomOperator& op,
                        RegionOutcome& outcome) {
    Real off = 0;  // size of the correction [J]
    for (std::size_t k = 0; k < region.joint.size(); ++k) {
        const std::size_t at = static_cast<std::size_t>(region.base) + region.row.size() + k;
        RegionMemory& data = stage.memory;
        off +=
            correct_joint(stage, stage.inputs.joints[static_cast<std::size_t>(region.joint[k])], region.memory.velocity,
                          {data.contact[at], data.rigid_part[at], data.joint_law[at - data.contact_rows]});
    }
    const Real small = region.tolerance * region.scale;
    if (off <= small * small && !stage.settings.fixed_iterations) return;
    const Index before = outcome.iterations;
    outcome =
        outcome_of(run_method(SolverMethod::ags, op, limits_of(stage.settings, region.tolerance)), stage.settings);
    outcome.iterations += before;
}

/// Adds the impulse of a contact to its nodes on implicit bodies, by their weights.
void write_deforming(const RegionStage& stage, const FreedomRegion& region, std::size_t i) {
    if (!stage.inputs.implicit.any()) return;
    const LumpedContact& contact = region.memory.contact[i];
    for (std::size_t a = 0; a < static_cast<std::size_t>(contact.node_count); ++a) {
        const Index node = region.node[static_cast<std::size_t>(contact.node[a])];
        const Index row = stage.inputs.implicit.row(node, stage.inputs.rigid.nodes);
        if (row != no_index)
            stage.out.deforming_impulse[static_cast<std::size_t>(row)] +=
                contact.weight[a] * region.memory.impulse[i].head<3>();
    }
}

/// Adds the impulse and moment of a contact or a joint to its rigid bodies.
void write_to_bodies(const RegionStage& stage, const RigidPart& part, const Vec4& impulse) {
    for (Index k = 0; k < part.term_count; ++k) {
        const RigidTerm& term = part.term[static_cast<std::size_t>(k)];
        const auto r = static_cast<std::size_t>(term.row);
        stage.out.contact_impulse[r] += term.weight * impulse.head<3>();
        stage.out.contact_moment[r] += cross(term.arm, impulse).head<3>() + term.turn * impulse.head<3>();
    }
}

void write_joints(const RegionStage& stage, const FreedomRegion& region) {
    for (std::size_t k = 0; k < region.joint.size(); ++k) {
        const std::size_t i = region.row.size() + k;
        const RigidPart& part = region.memory.part[i];
        write_to_bodies(stage, part, region.memory.impulse[i]);
        stage.out.joint_impulse[static_cast<std::size_t>(region.joint[k])] =
            matrix_of(part.frame).transpose() * region.memory.impulse[i].head<3>();
    }
}

/// Writes impulses, the velocities of all nodes of contacts, and the impulses on rigid bodies.
void write_solution(const RegionStage& stage, const FreedomRegion& region, RegionOutcome& outcome) {
    const FreedomMemory& memory = region.memory;
    const RigidInputs& rigid = stage.inputs.rigid;
    for (std::size_t n = 2 * region.rigid.size(); n < region.node.size(); ++n)
        if (stage.inputs.implicit.row(region.node[n], rigid.nodes) == no_index)  // else its frame moves it, too
            stage.out.velocity_next[static_cast<std::size_t>(region.node[n])] = memory.velocity[n].head<3>();
    for (std::size_t i = 0; i < region.row.size(); ++i) {
        const auto row = static_cast<std::size_t>(region.row[i]);
        write_to_bodies(stage, memory.part[i], memory.impulse[i]);
        const Stencil& stencil = stage.inputs.stencil[row];
        for (std::size_t a = 0; a < 4; ++a) {
            const Index node = stencil.node[a];
            const bool moves = stencil.weight[a] != 0 && stage.inputs.inverse_mass[static_cast<std::size_t>(node)] > 0;
            const Index body = moves ? rigid.nodes.row(node) : no_index;
            if (body == no_index) continue;
            const auto slot = static_cast<std::size_t>(
                2 * (std::find(region.rigid.begin(), region.rigid.end(), body) - region.rigid.begin()));
            const Vec3 arm =
                rigid.position[static_cast<std::size_t>(node)] - rigid.center[static_cast<std::size_t>(body)];
            Vec3& next = stage.out.velocity_next[static_cast<std::size_t>(node)];
            next = memory.velocity[slot].head<3>() + memory.velocity[slot + 1].head<3>().cross(arm);
            if (stage.inputs.implicit.row(node, rigid.nodes) != no_index)
                next += memory.velocity[static_cast<std::size_t>(stage.memory.place[static_cast<std::size_t>(node)])]
                            .head<3>();
        }
        write_deforming(stage, region, i);
        stage.out.impulse[row] = memory.impulse[i].head<3>();
        outcome.dissipated += dissipated_by(stage, region.row[i]);
    }
    write_joints(stage, region);
}

/// Variant of push_work that includes the force impulses on rigid bodies [J]
Real push_work_of(const RegionStage& stage, const FreedomRegion& region, std::span<const Vec4> push_velocity) {
    const RigidInputs& rigid = stage.inputs.rigid;
    const std::size_t first_node = 2 * region.rigid.size();
    // The share of the nodes, as if there were no rigid bodies.
    LumpedMemory nodes;
    nodes.contact = region.memory.contact;
    nodes.impulse = region.memory.impulse;
    nodes.velocity = region.memory.velocity;
    nodes.node = region.node;
    Real work = push_work_through_clusters(stage, nodes, push_velocity, first_node);
    for (std::size_t k = 0; k < region.rigid.size(); ++k) {
        const auto r = static_cast<std::size_t>(region.rigid[k]);
        work -= rigid.kick[r].dot(push_velocity[2 * k].head<3>()) +
                rigid.spins.moment_kick[r].dot(push_velocity[2 * k + 1].head<3>());
    }
    return work;
}

void push_out(const RegionStage& stage, const FreedomRegion& region, const FreedomOperator& op,
              RegionOutcome& outcome) {
    if (!push_freedom(stage, region, op)) return;
    const std::span<const Vec4> velocity = region.memory.scratch;
    for (std::size_t k = 0; k < region.rigid.size(); ++k) {
        const auto r = static_cast<std::size_t>(region.rigid[k]);
        stage.out.push_velocity[r] = velocity[2 * k].head<3>();
        stage.out.push_spin[r] = velocity[2 * k + 1].head<3>();
    }
    for (std::size_t n = 2 * region.rigid.size(); n < region.node.size(); ++n)
        if (stage.inputs.implicit.row(region.node[n], stage.inputs.rigid.nodes) == no_index)
            stage.out.push_out[static_cast<std::size_t>(region.node[n])] = velocity[n].head<3>();
    outcome.push_work = push_work_of(stage, region, velocity);
    stage.memory.pushed.store(true, std::memory_order_relaxed);
}

}  // namespace

RegionOutcome solve_freedom(const RegionStage& stage, std::span<const Index> row, std::span<const Index> joints,
                            Index number, Index base) {
    if (!joints.empty()) base = static_cast<Index>(stage.memory.joint_base[static_cast<std::size_t>(number)]);
    const FreedomRegion region = Loading(stage, row, joints, number, base).load();
    FreedomOperator op = region.operator_for(stage);
    RegionOutcome outcome;
    if (!start(stage, region, op, outcome))
        outcome = outcome_of(run_method(joints.empty() ? stage.settings.method : SolverMethod::ags, op,
                                        limits_of(stage.settings, region.tolerance)),
                             stage.settings);
    if (!joints.empty() && outcome.status != RegionStatus::not_finite) hold_joints_at_end(stage, region, op, outcome);
    write_solution(stage, region, outcome);
    if (outcome.status != RegionStatus::not_finite) push_out(stage, region, op, outcome);
    return outcome;
}

}  // namespace skerry
