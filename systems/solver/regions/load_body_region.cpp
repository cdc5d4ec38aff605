#include <Eigen/Geometry>
#include <algorithm>

#include "systems/solver/local/load_contact.h"
#include "systems/solver/regions/body_region.h"
#include "systems/solver/regions/region_blocks.h"

namespace skerry {
namespace {

const NodeClusters no_clusters;

/// Loads one region.
class Loading {
public:
    Loading(const RegionStage& stage, const RegionRows& rows, Index number, Index base)
        : stage_(stage),
          data_(stage.memory),
          number_(static_cast<std::size_t>(number)),
          points_(points_of_cables(stage.inputs, rows.cable)),
          list_(data_, data_.node_base[number_],
                room_of_region(stage.inputs, data_, rows.contact.size() + points_, number)),
          region_{{.row = rows.contact,
                   .base = base,
                   .traversal = ThroughGroups(stage.inputs.clustered() ? *stage.inputs.clusters : no_clusters,
                                              stage.inputs.implicit, stage.inputs.rigid, list_.node()),
                   .memory = memory_of(rows, base),
                   // tolerance_of() returns a smaller tolerance for regions of bodies that are still. It checks only
                   // the bodies of contacts, so it is not used for regions with joints or cables.
                   .tolerance = rows.joint.empty() && rows.cable.empty() ? tolerance_of(stage, rows.contact)
                                                                         : stage.settings.tolerance},
                  rows.joint,
                  rows.cable,
                  data_.region_rigid[number_]} {}

    BodyRegion load() {
        add_velocity_rows();
        for (std::size_t k = 0; k < region_.joint.size(); ++k) load_joint_at(k);
        load_cables();
        load_contacts(stage_, region_, [this](std::size_t i, std::size_t, LumpedContact& contact) {
            RigidPart& part = region_.memory.part[i];
            load_contact_at(i, contact, part);
            const Vec4* const velocity = region_.memory.velocity.data();
            return Vec4(contact.offset +
                        add_rigid_velocities(part, velocity, add_node_velocities(contact, velocity, Vec4::Zero())));
        });
        list_.trim(region_.memory);
        const std::span<Vec4> free =
            data_.free_velocity.span().subspan(data_.node_base[number_], region_.memory.velocity.size());
        std::ranges::copy(region_.memory.velocity, free.begin());
        region_.memory.free_velocity = free;
        return region_;
    }

private:
    BodyMemory memory_of(const RegionRows& rows, Index base) const {
        const auto first = static_cast<std::size_t>(base);
        const std::size_t slots = body_workspace_slots(stage_.settings.method);
        const std::size_t contacts = rows.contact.size(), joints = rows.joint.size(),
                          count = contacts + joints + points_;
        BodyMemory memory;
        static_cast<ContactMemory&>(memory) =
            memory_from(stage_, base, count, data_.node_base[number_], list_.node(), slots);
        memory.contacts = static_cast<Index>(contacts);
        memory.cable = rows.cable;
        memory.cable_law = data_.cable_law;
        memory.part = data_.rigid_part.span().subspan(first, count);
        if (joints > 0) memory.joint = data_.joint_law.span().subspan(first + contacts - data_.contact_rows, joints);
        return memory;
    }

    /// Adds velocity rows of the rigid bodies, of the nodes of implicit bodies that have contacts, and of the nodes of
    /// clusters.
    void add_velocity_rows() {
        const RigidInputs& rigid = stage_.inputs.rigid;
        for (const Index body : region_.rigid) {
            const auto r = static_cast<std::size_t>(body);
            list_.add(no_index, padded(rigid.velocity(r)));
            list_.add(no_index, padded(rigid.spins.kicked(r)));
        }
        if (stage_.inputs.implicit.any())
            for (const Index body : region_.rigid)
                for (const Index n : stage_.inputs.implicit.coupling->nodes[static_cast<std::size_t>(body)])
                    velocity_row_of(n);
        for (const Index c : data_.region_clusters[number_])
            for (const Index n : stage_.inputs.clusters->nodes[static_cast<std::size_t>(c)]) velocity_row_of(n);
    }

    /// Returns the velocity row of a node in the region.
    Index velocity_row_of(Index node) {
        return list_.index_of(node, [&]() -> Vec4 {
            const RigidNodes& rigid = stage_.inputs.rigid.nodes;
            const Index row = stage_.inputs.implicit.row(node, rigid);
            if (row == no_index) return free_velocity_of(stage_, node);
            return padded(stage_.inputs.implicit.deforming(row, rigid.row(node)));
        });
    }

    void load_contact_at(std::size_t i, LumpedContact& contact, RigidPart& part) {
        const RigidNodes& rigid = stage_.inputs.rigid.nodes;
        part.term_count = 0;
        contact = load_contact(
            stage_.inputs, region_.row[i], stage_.out.velocity_next, stage_.settings, stage_.h,
            [&](Index node) { return velocity_row_of(node); },
            [&](Index node, Real weight) {
                const Index body = rigid.row(node);
                const auto row = static_cast<std::size_t>(region_.row[i]);
                const bool is_tie = stage_.inputs.is_tie(region_.row[i]);
                const Vec3& acts_at = is_tie ? stage_.inputs.touch.point[row]
                                             : stage_.inputs.rigid.position[static_cast<std::size_t>(node)];
                if (body != no_index)
                    add_term(part, body, acts_at, weight, [&] {
                        // Moment arm from the core of a round body to its surface.
                        return is_tie ? Vec3(Vec3::Zero())
                                      : rigid.core_arm(node, weight, row, contact_normal(i), stage_.inputs.touch);
                    });
                return body != no_index && stage_.inputs.implicit.row(node, rigid) == no_index;
            });
        const std::span<const FrictionAxis> axes = stage_.inputs.friction_axis;
        const FrictionAxis axis = axes.empty() ? FrictionAxis{} : axes[static_cast<std::size_t>(region_.row[i])];
        region_.has_axes |= axis.across != 1;
        find_mobility(contact, part, axis);
    }

    void load_cables() {
        const SolvedCables& cables = stage_.inputs.cables;
        std::size_t i = region_.row.size() + region_.joint.size();
        for (const Index cable : region_.cable) {
            const auto first = static_cast<Index>(i);
            const CableBlock& block = cables.block[static_cast<std::size_t>(cable)];
            for (Index p = block.points.begin; p < block.points.end; ++p) {
                load_point(static_cast<std::size_t>(p), block.acting_point(p),
                           data_.contact[static_cast<std::size_t>(region_.base) + i], region_.memory.part[i]);
                region_.memory.impulse[i++].setZero();
            }
            load_cable(stage_, cable, region_.memory, region_.traversal, first, region_.sums);
        }
    }

    /// Loads a point of a cable. `acts_at`: point at which impulses act on rigid and implicit bodies; if it is null,
    /// they act at the nodes of the stencil. LumpedContact::offset gets the velocity that no impulse changes: that of
    /// held nodes plus CableBlockTable::velocity.
    void load_point(std::size_t point, const Vec3* acts_at, LumpedContact& contact, RigidPart& part) {
        const RigidNodes& rigid = stage_.inputs.rigid.nodes;
        const Stencil& stencil = stage_.inputs.cables.stencil[point];
        Vec3 offset = stage_.inputs.cables.velocity[point];
        contact = LumpedContact{};
        contact.normal = padded(Vec3(Vec3::UnitZ()));
        part.term_count = 0;
        for (std::size_t a = 0; a < 4; ++a) {
            const Index node = stencil.node[a];
            const Real weight = stencil.weight[a];
            if (weight == 0) continue;
            const Real inverse_mass = stage_.inputs.inverse_mass[static_cast<std::size_t>(node)];
            if (!(inverse_mass > 0)) {
                offset += weight * stage_.out.velocity_next[static_cast<std::size_t>(node)];
                continue;
            }
            const Index body = rigid.row(node);
            if (body != no_index)
                add_term(part, body,
                         acts_at != nullptr ? *acts_at : stage_.inputs.rigid.position[static_cast<std::size_t>(node)],
                         weight, [] { return Vec3(Vec3::Zero()); });
            if (body != no_index && stage_.inputs.implicit.row(node, rigid) == no_index) continue;
            const auto index = static_cast<std::size_t>(contact.node_count++);
            contact.weight[index] = weight;
            contact.step[index] = weight * inverse_mass;
            contact.node[index] = velocity_row_of(node);
        }
        contact.offset = padded(offset);
        find_mobility(contact, part, FrictionAxis{});
    }

    void load_joint_at(std::size_t k) {
        const LoadedJoint loaded = region_.loaded_joint(stage_, k);
        const JointBlock& block = stage_.inputs.joints[static_cast<std::size_t>(region_.joint[k])];
        load_joint(stage_, block, region_.rigid, loaded);
        region_.memory.impulse[region_.row.size() + k].setZero();
        if (block.mimic.coefficient != 0) {
            region_.sums.separating = false;
            if (block.mimic.leads) load_mimic(region_.loaded_joint(stage_, k - 1), loaded);
            return;
        }
        const Vec4 u = add_rigid_velocities(loaded.part, region_.memory.velocity.data(), loaded.contact.offset);
        add_joint(loaded, u, region_.sums);
    }

    const Vec3& contact_normal(std::size_t i) const {
        return stage_.inputs.normal[static_cast<std::size_t>(region_.row[i])];
    }

    /// Adds a node that moves with a rigid body to the RigidTerm of this body in `part`. `acts_at`: point at which the
    /// impulse acts. `beside()`: initial value of RigidTerm::arm, to which the weighted arms of the nodes are added
    /// [m].
    void add_term(RigidPart& part, Index body, const Vec3& acts_at, Real weight, auto&& beside) {
        const RigidInputs& rigid = stage_.inputs.rigid;
        Index k = 0;
        while (k < part.term_count && part.term[static_cast<std::size_t>(k)].row != body) ++k;
        RigidTerm& term = part.term[static_cast<std::size_t>(k)];
        if (k == part.term_count) {
            ++part.term_count;
            const auto rigid_index =
                std::find(region_.rigid.begin(), region_.rigid.end(), body) - region_.rigid.begin();
            term = {.row = body,
                    .slot = static_cast<Index>(2 * rigid_index),
                    .arm = padded(Vec3(beside())),
                    .spin_step = {}};
        }
        term.weight += weight;
        term.arm += weight * padded(acts_at - rigid.center[static_cast<std::size_t>(body)]);
    }

    void find_mobility(LumpedContact& contact, RigidPart& part, const FrictionAxis& axis) const {
        const bool moves_nodes = contact.node_count > 0;
        Mat3 mobility = moves_nodes ? region_.traversal.coupling(contact, contact) : Mat3(Mat3::Zero());
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
        part.across = axis.across;
        const TangentFrame tangents =
            axis.across == 1 ? tangent_frame(normal) : TangentFrame{axis.direction, normal.cross(axis.direction)};
        part.frame = {contact.normal, padded(tangents.first), padded(tangents.second)};
        part.mobility = columns_of(mobility);
        part.along_normal = normal.dot(mobility * normal);
        if (moves_nodes && part.term_count > 0 && stage_.inputs.implicit.any())
            part.along_normal = normal.dot((region_.traversal.undeformed_coupling(contact, contact) + rigid) * normal);
        part.max_eigenvalue = part.term_count > 0 ? mobility.norm() : mobility(0, 0);
        if (part.term_count > 0 || part.across != 1) {
            Mat3 frame = matrix_of(part.frame);
            frame.col(2) *= part.across;
            part.block = prepare_block(frame.transpose() * mobility * frame);
        }
        contact.diagonal = mobility.trace() / 3;
        contact.inverse_diagonal = contact.diagonal > 0 ? 1 / contact.diagonal : 0;
    }

    const RegionStage& stage_;
    RegionMemory& data_;
    const std::size_t number_;
    const std::size_t points_;  // number of points of cables
    NodeList list_;
    BodyRegion region_;
};

}  // namespace

BodyRegion load_body_region(const RegionStage& stage, const RegionRows& rows, Index number, Index base) {
    if (!rows.joint.empty() || !rows.cable.empty())
        base = static_cast<Index>(stage.memory.joint_base[static_cast<std::size_t>(number)]);
    return Loading(stage, rows, number, base).load();
}

}  // namespace skerry
