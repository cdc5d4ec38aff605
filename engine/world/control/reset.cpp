// Resets bodies to their rest shapes, and a world to a saved state.
#include <Eigen/Geometry>
#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/world/control/control.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "skerry/world.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Sets to zero the impulses and forces that the last step has stored for contacts, joints, ties, cables, fibres and
/// springs of a body, because the next step would start from them. Joints get back the coordinates with which they were
/// added.
void forget_impulses(WorldState& world, std::size_t body) {
    Model& model = world.model;
    const std::uint32_t slot = model.bodies.slot[body];
    const auto forget = [slot](std::span<const ContactKey> key, std::span<Vec3> impulse) {
        for (std::size_t c = 0; c < key.size(); ++c) {
            const PairSlots pair = slots_of_pair(key[c].pair);
            if (pair.first == slot || (!pair.is_collider && pair.second == slot)) impulse[c] = Vec3::Zero();
        }
    };
    forget(world.cache.warm_start.key, world.cache.warm_start.impulse);
    forget(world.cache.resting.contact.key, world.cache.resting.contact.impulse);
    JointTable& joints = model.joints;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const auto joins = [&](Index joint) {
            const auto row = static_cast<std::size_t>(joint);
            return joints.first[row] == static_cast<Index>(body) || joints.second[row] == static_cast<Index>(body);
        };
        const bool own = joins(static_cast<Index>(j));
        if (own || (joints.leader[j] != no_index && joins(joints.leader[j]))) joints.mimic_impulse[j] = 0;
        if (!own) continue;
        joints.impulse[j] = joints.moment[j] = Vec3::Zero();
        joints.coordinate[j] = joints.first_coordinate[j];  // includes the complete revolutions of a hinge
        joints.step[j] = 0;
        joints.axis_impulse[j] = {};
    }
    TieTable& ties = model.ties;
    for (std::size_t t = 0; t < ties.size(); ++t) {
        if (ties.first[t] != static_cast<Index>(body) && ties.second[t] != static_cast<Index>(body)) continue;
        std::ranges::fill(rows_of(ties.impulse, ties.nodes[t]), Vec3::Zero());
        ties.step[t] = 0;
    }
    CableTable& cables = model.cables;
    for (std::size_t c = 0; c < cables.size(); ++c) {
        const std::span<const Index> bodies = rows_of(cables.anchor.body, cables.points[c]);
        if (std::ranges::find(bodies, static_cast<Index>(body)) == bodies.end()) continue;
        std::ranges::fill(rows_of(cables.tension, cables.points[c]), Real(0));
        cables.step[c] = 0;
    }
    FibreTable& fibres = model.fibres;
    for (std::size_t f = 0; f < fibres.size(); ++f)
        if (fibres.body[f] == static_cast<Index>(body))
            std::ranges::fill(rows_of(fibres.passive, fibres.tetrahedra[f]), Vec3::Zero());
    SpringTable& springs = model.springs;
    for (std::size_t s = 0; s < springs.size(); ++s) {
        if (springs.first.body[s] != static_cast<Index>(body) && springs.second.body[s] != static_cast<Index>(body))
            continue;
        springs.force[s] = Vec3::Zero();
        springs.tension[s] = springs.elastic[s] = springs.rest_rate[s] = 0;
    }
}

/// Sets the spring strains of the Maxwell elements of a body to zero. Sets the corotational frames of its elements to
/// `turn`, the rotation of the body since its elements were built.
void relax_elements(Model& model, std::size_t body, const Mat3& turn) {
    ElementBlockTable& elements = model.elements;
    const Range blocks = model.bodies.blocks[body];
    const Eigen::Quaternion<Real> q(turn);
    for (Index b = blocks.begin; b < blocks.end; ++b) {
        elements.spring_strain[b] = elements.spring_strain_next[b] = SpringStrain{};
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const std::array<Real, 4> components{q.w(), q.x(), q.y(), q.z()};
            for (std::size_t i = 0; i < components.size(); ++i) elements.rotation[b][i][l] = components[i];
        }
        elements.rotation_next[b] = elements.rotation[b];
    }
    // The clusters (groups of nodes whose elements are integrated implicitly) were chosen for the deformed shape, so
    // they must be chosen again.
    model.clusters_open |= model.bodies.cluster_step[body] > 0;
}

/// Undoes the deformation of an implicit body whose nodes are already at their positions at rest.
void undo_deformation(Model& model, std::size_t body) {
    const Range nodes = model.bodies.nodes[body], rows = model.bodies.implicit[body];
    const auto clear = [&] {
        std::ranges::fill(rows_of(model.implicit_nodes.displacement, rows), Vec3::Zero());
        std::ranges::fill(rows_of(model.implicit_nodes.velocity, rows), Vec3::Zero());
        std::ranges::fill(rows_of(model.implicit_nodes.left, rows), Vec3::Zero());
    };
    clear();
    if (model.is_held(body)) {
        follow_attachments(model, body);
        return;
    }
    const std::span<const Vec3> position = rows_of(model.nodes.position, nodes);
    set_deformed_shape(model, body, std::vector<Vec3>(position.begin(), position.end()));
    clear();  // removes displacements of the size of rounding errors
}

void reset_body(WorldState& world, std::size_t body, const RigidPose& pose) {
    Model& model = world.model;
    const Range nodes = model.bodies.nodes[body];
    std::vector<Vec3> position;
    for (const Vec3& rest : rows_of(model.nodes.rest_position, nodes))
        position.push_back(pose.position + pose.rotation * rest);
    undo_flow(model, body);
    relax_elements(model, body, pose.rotation * model.body_records[body].built.transpose());
    place_nodes(world, body, position);
    std::ranges::copy(position, rows_of(model.nodes.still_position, nodes).begin());
    for (Index n = nodes.begin; n < nodes.end; ++n)
        if (model.nodes.inverse_mass[n] > 0) model.nodes.velocity[n] = Vec3::Zero();
    hold_here(model, body, world.clock.time);
    if (model.has_frame(body)) {
        const auto r = static_cast<std::size_t>(model.bodies.rigid[body].begin);
        find_holding_attachments(model);
        if (!model.is_held(body)) stop_rigid_body(model, body);
        if (!model.is_rigid(body)) undo_deformation(model, body);
        if (model.is_rigid(body) || !model.is_held(body))
            set_rigid_pose(model, body, pose.position + pose.rotation * model.rigid_bodies.rest_center[r],
                           pose.rotation * model.rigid_bodies.axes[r]);
    }
    forget_impulses(world, body);
}

}  // namespace

void World::reset(BodyHandle body) {
    state_->require_between_steps("reset");
    state_->settle();
    const auto row = static_cast<std::size_t>(state_->model.row(body, "reset"));
    reset_body(*state_, row, state_->model.body_records[row].start);
}

void World::reset(BodyHandle body, const Pose& pose) {
    state_->require_between_steps("reset");
    state_->settle();
    const auto row = static_cast<std::size_t>(state_->model.row(body, "reset"));
    validate(pose, "body '" + state_->model.body_records[row].name + "'");
    reset_body(*state_, row, {pose.position, rotation_matrix(pose.rotation)});
}

void World::reset() {
    state_->require_between_steps("reset");
    state_->settle();
    for (std::size_t b = 0; b < state_->model.bodies.slot.size(); ++b)
        if (state_->model.bodies.kind[b] == BodyKind::deformable)
            reset_body(*state_, b, state_->model.body_records[b].start);
}

void World::reset(const World& saved) {
    state_->require_between_steps("reset");
    if (&saved == this) return;
    if (saved.state_->model.body_map.world() != state_->model.body_map.world())
        refuse("reset", "saved", "another world", "a clone() of this world");
    World copy = saved.clone();
    WorldState &now = *copy.state_, &before = *state_;
    now.model.settings.backend = before.model.settings.backend;
    now.model.settings.threads = before.model.settings.threads;
    // Handles of objects that were added after the clone stay stale, even if later objects reuse their slots.
    now.model.material_map.differ_from(before.model.material_map);
    now.model.body_map.differ_from(before.model.body_map);
    now.model.collider_map.differ_from(before.model.collider_map);
    now.model.attachment_map.differ_from(before.model.attachment_map);
    now.model.for_each_joining([&](const char*, auto&, auto& map) {
        before.model.for_each_joining([&](const char*, auto&, const auto& map_before) {
            if constexpr (requires { map.differ_from(map_before); }) map.differ_from(map_before);
        });
    });
    std::swap(now.executor, before.executor);
    now.record.tracing = before.record.tracing;
    std::swap(now.record.problem_watch, before.record.problem_watch);
    std::swap(now.record.step_watch, before.record.step_watch);
    *this = std::move(copy);
}

}  // namespace skerry
