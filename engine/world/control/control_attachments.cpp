// Attachments: nodes of a body that are held or moved by a script.
#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/validate.h"
#include "engine/world/world_state.h"
#include "systems/dynamics/rigid/move_rigid_bodies.h"

namespace skerry {

namespace {

// Two directions count as perpendicular if the absolute cosine of their angle is at most this number. They count as
// parallel if the cosine is at least 1 minus this number.
constexpr Real perpendicular_tolerance = 1e-9;

/// Returns the matrix for AttachmentTable::held, whose columns are the unit vectors of the directions. It is the
/// identity for no directions, or three: nodes are then held completely. Throws SceneError unless there are at most
/// three nonzero directions, perpendicular to each other.
Mat3 held_directions(const std::vector<Vec3>& directions) {
    if (directions.empty()) return Mat3::Identity();
    if (directions.size() > 3)
        refuse("attach", "directions", std::to_string(directions.size()) + " directions", "at most three directions");
    Mat3 held = Mat3::Zero();
    for (std::size_t d = 0; d < directions.size(); ++d) {
        require_finite("attach", "directions", directions[d]);
        if (!(directions[d].norm() > 0)) refuse("attach", "directions", "a vector of length 0", "a nonzero length");
        const Vec3 unit = directions[d].normalized();
        if (!((held.transpose() * unit).cwiseAbs().maxCoeff() <= perpendicular_tolerance))
            refuse("attach", "directions", short_text(directions[d]), "a direction perpendicular to those before it");
        held.col(static_cast<Index>(d)) = unit;
    }
    return directions.size() == 3 ? Mat3(Mat3::Identity()) : held;
}

/// Throws SceneError if nodes cannot be held along the directions `held`: the body is not explicit, or another
/// attachment holds one of the nodes along a direction that is neither perpendicular nor parallel to these directions.
void require_axes(const Model& model, std::size_t body, std::span<const Index> nodes, const Mat3& held) {
    const std::string& name = model.body_records[body].name;
    if (model.has_frame(body))
        refuse("attach", "directions",
               std::string("the ") + (model.is_rigid(body) ? "rigid" : "implicit") + " body '" + name + "'",
               "an explicit body",
               model.is_rigid(body) ? "join a rigid body to the world by a slider or another joint"
                                    : "set the dynamics of the body to explicit, or tie its nodes to a "
                                      "plane collider by a tie of kind slide");
    const AttachmentTable& table = model.attachments;
    for (std::size_t a = 0; a < table.slot.size(); ++a) {
        if (table.body[a] != static_cast<Index>(body) || holds_completely(table.held[a])) continue;
        const Mat3 cosines = (table.held[a].transpose() * held).cwiseAbs();
        if (((cosines.array() <= perpendicular_tolerance) || (cosines.array() >= 1 - perpendicular_tolerance)).all())
            continue;
        for (const Index row : rows_of(table.node, table.nodes[a]))
            if (const Index n = row - model.bodies.nodes[body].begin; std::ranges::find(nodes, n) != nodes.end())
                refuse("attach", "directions",
                       "node " + std::to_string(n) + " of body '" + name +
                           "', which another attachment holds along an oblique direction",
                       "directions that are perpendicular or equal to those of other attachments of the node");
    }
}

}  // namespace

AttachmentHandle World::attach(BodyHandle body, std::span<const Index> nodes, const Motion& motion, const Vec3& pivot,
                               const std::vector<Vec3>& directions) {
    state_->require_between_steps("attach");
    Model& model = state_->model;
    const Index row = model.row(body, "attach");
    const auto b = static_cast<std::size_t>(row);
    validate(motion, pivot);
    const Index count = model.bodies.nodes[b].size();
    if (nodes.empty()) refuse("attach", "nodes", "no nodes", "at least one node of the body");
    require_nodes("attach", nodes, count);
    if (model.bodies.core_nodes[b] > 0)
        refuse("attach", "body", std::string("the ") + model.round_name(b) + " '" + model.body_records[b].name + "'",
               "a body with a mesh",
               std::string("to prescribe its motion, replace the ") + model.round_name(b) + " by a collider");
    const bool rigid = model.is_rigid(b), implicit = model.has_frame(b) && !rigid;
    const Mat3 held = held_directions(directions);
    if (!holds_completely(held) && (motion.turns() || !motion.angular_velocity.isZero(0)))
        refuse("attach", "directions", "a motion with a rotation", "a motion without rotation");
    if (implicit && model.body_records[b].choice.reason != DynamicsReason::given) {
        set_dynamics(body, BodyDynamics::explicit_elastic);
        return attach(body, nodes, motion, pivot, directions);
    }
    if (!holds_completely(held)) require_axes(model, b, nodes, held);
    if (model.has_frame(b) && !hold_whole(model, b, nodes))
        refuse("attach", "nodes",
               std::to_string(nodes.size()) + " nodes of the " + (rigid ? "rigid" : "implicit") + " body '" +
                   model.body_records[b].name + "'",
               std::string("three or more nodes that are not on one line, to hold ") +
                   (rigid ? "the whole body" : "the body's rotating frame"));
    state_->require_between_steps("attach");
    std::vector<Index> numbers(nodes.begin(), nodes.end());
    if (rigid) {
        numbers.resize(static_cast<std::size_t>(count));
        std::iota(numbers.begin(), numbers.end(), 0);
        stop_rigid_body(model, b);
    }
    const AttachmentHandle handle = model.attachment_map.insert(static_cast<Index>(model.attachments.slot.size()));
    append_attachment(model, handle.slot, row, numbers, {pivot, Mat3::Identity()}, motion, state_->clock.time, held);
    if (implicit) {
        find_holding_attachments(model);
        follow_attachments(model, b);
    }
    model.wake(b);
    // The contact pairs of the body are searched again, because the last search assumed the earlier speeds of the nodes
    // that are now held.
    state_->cache.forget_body(model, b);
    if (!holds_completely(held)) model.clusters_open = true;
    state_->edits.rows = state_->edits.elements = true;
    return handle;
}

void World::remove(AttachmentHandle attachment) {
    state_->require_between_steps("remove");
    const Index row = state_->model.row(attachment, "remove");
    state_->record.forces.forget_attachment(attachment.slot);
    Model& model = state_->model;
    const auto body = static_cast<std::size_t>(model.attachments.body[static_cast<std::size_t>(row)]);
    model.wake(body);
    model.attachment_map.forget(attachment);
    model.clusters_open |= !holds_completely(model.attachments.held[static_cast<std::size_t>(row)]);
    erase_attachment(model, row);
    if (model.dynamics_of(body) == BodyDynamics::implicit_elastic) {
        find_holding_attachments(model);
        follow_attachments(model, body);
    }
    state_->edits.rows = state_->edits.elements = true;
}

std::vector<AttachmentHandle> World::attachments() const {
    state_->settle();
    const AttachmentTable& table = state_->model.attachments;
    std::vector<AttachmentHandle> handles;
    for (std::size_t a = 0; a < table.slot.size(); ++a)
        if (state_->model.bodies.kind[static_cast<std::size_t>(table.body[a])] == BodyKind::deformable)
            handles.push_back(state_->model.attachment_map.handle_of_slot(table.slot[a]));
    return handles;
}

BodyHandle World::body(AttachmentHandle attachment) const {
    state_->settle();
    const auto row = static_cast<std::size_t>(state_->model.row(attachment, "body"));
    const auto body = static_cast<std::size_t>(state_->model.attachments.body[row]);
    return state_->model.body_map.handle_of_slot(state_->model.bodies.slot[body]);
}

std::vector<Index> World::nodes(AttachmentHandle attachment) const {
    state_->settle();
    const AttachmentTable& table = state_->model.attachments;
    const auto row = static_cast<std::size_t>(state_->model.row(attachment, "nodes"));
    const Index first = state_->model.bodies.nodes[static_cast<std::size_t>(table.body[row])].begin;
    std::vector<Index> numbers;
    for (const Index node : rows_of(table.node, table.nodes[row])) numbers.push_back(node - first);
    return numbers;
}

std::vector<Vec3> World::directions(AttachmentHandle attachment) const {
    const Mat3& held =
        state_->model.attachments.held[static_cast<std::size_t>(state_->model.row(attachment, "directions"))];
    std::vector<Vec3> directions;
    if (held.isIdentity(0)) return directions;
    for (const Vec3 direction : held.colwise())
        if (!direction.isZero(0)) directions.push_back(direction);
    return directions;
}

}  // namespace skerry
