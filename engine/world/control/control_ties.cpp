// Functions that add, remove and change ties between steps (docs/methods/ties.md).
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/objects.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/query/fitted_tree.h"
#include "engine/world/query/place_anchor.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "skerry/tie.h"
#include "systems/collision/inputs/may_collide.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/contact/prepare_ties.h"
#include "systems/dynamics/motion/move_colliders.h"

namespace skerry {

namespace {

/// `first`: row of the tied body. `second` or `collider`: row of the body or collider to which it is tied; if both are
/// no_index, it is tied to the world.
struct TiedObjects {
    Index first, second = no_index, collider = no_index;
};

std::string title_of_tied(const Model& model, Index body) {
    return title_of_end(model, body, no_index);
}

std::string title_of_tie(const Model& model, const TiedObjects& objects) {
    return "tie of " + title_of_tied(model, objects.first) + " to " +
           title_of_end(model, objects.second, objects.collider);
}

[[noreturn]] void refuse_tie(const Model& model, const TiedObjects& objects, const char* field,
                             const std::string& found, const std::string& expected) {
    refuse(title_of_tie(model, objects), field, found, expected);
}

void validate_break_force(const Model& model, const TiedObjects& objects, Real force) {
    if (!(force > 0)) refuse_tie(model, objects, "break_force", short_text(force), "a force > 0 (N)");
}

void validate_nodes(const Model& model, const TiedObjects& objects, const std::vector<Index>& nodes) {
    if (nodes.empty())
        refuse_tie(model, objects, "nodes", "no node", "at least one node of " + title_of_tied(model, objects.first));
    require_different_nodes(title_of_tie(model, objects), nodes,
                            model.bodies.nodes[static_cast<std::size_t>(objects.first)].size());
}

/// Present poses of all colliders.
std::vector<RigidMotion> present_poses(const WorldState& world) {
    const ColliderTable& table = world.model.colliders;
    std::vector<RigidMotion> poses;
    for (std::size_t c = 0; c < table.slot.size(); ++c) {
        const RigidPose pose = pose_at(table.script[c], table.keyframe, table.initial[c], world.clock.time);
        poses.push_back({pose.position, pose.rotation, Vec3::Zero(), Vec3::Zero()});
    }
    return poses;
}

TiedObjects objects_of(const Model& model, const TieSettings& tie) {
    TiedObjects objects{model.row(tie.body, "add_tie")};
    if (tie.to_body) objects.second = model.row(*tie.to_body, "add_tie");
    if (tie.to_collider) objects.collider = model.row(*tie.to_collider, "add_tie");
    const auto refuse_objects = [&](const char* field, const std::string& found, const std::string& expected) {
        refuse_tie(model, objects, field, found, expected);
    };
    if (tie.to_body && tie.to_collider)
        refuse_objects("to_body, to_collider", "a body and a collider", "one of the two");
    if (model.is_rigid(static_cast<std::size_t>(objects.first)))
        refuse_objects("body", title_of_tied(model, objects.first) + ", which is rigid",
                       "a deformable body (ties fix its nodes; joints connect rigid bodies)");
    if (objects.second == objects.first)
        refuse_objects("to_body", title_of_tied(model, objects.first) + " itself",
                       "another body, a collider or the world");
    if (tie.kind == TieKind::slide && !tie.to_body && !tie.to_collider)
        refuse_objects("kind", "a slide to the world, which has no surface",
                       "a body or collider to slide on, or a weld");
    return objects;
}

/// Point of a surface that is nearest to a given point. If the surface has triangles: nodes `corner` (local numbers) of
/// the triangle with the point, and barycentric coordinates `weight` of the point.
struct OnSurface {
    Vec3 point, normal;
    std::array<Index, 3> corner{};
    Vec3 weight = Vec3::Zero();
};

/// Point nearest to `point` on the surface of `body`: the second body of the tie, or the mesh of its collider.
OnSurface on_triangles(WorldState& world, const TiedObjects& objects, std::size_t body, const Vec3& point) {
    const Model& model = world.model;
    const std::optional<TrianglePoint> found = nearest_point(fitted_tree(world, body), point, infinity);
    if (!found)
        refuse_tie(model, objects, "to_body", title_of_tied(model, static_cast<Index>(body)) + ", which has no surface",
                   "a body with a surface");
    const auto& corner = model.surface.triangles.node[static_cast<std::size_t>(found->triangle)];
    const auto at = [&](std::size_t a) -> const Vec3& {
        return model.nodes.position[static_cast<std::size_t>(corner[a])];
    };
    OnSurface place{.point = Vec3::Zero(), .normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized()};
    for (std::size_t a = 0; a < 3; ++a) {
        place.corner[a] = corner[a] - model.bodies.nodes[body].begin;
        place.weight[static_cast<Index>(a)] = found->weight[a];
        place.point += found->weight[a] * at(a);
    }
    return place;
}

OnSurface on_shape(const ColliderGeometry& geometry, const RigidMotion& pose, const Vec3& point) {
    const SurfacePoint found = distance_to_collider(geometry, pose, point);
    return {.point = found.point, .normal = found.normal};
}

/// Point nearest to `point` on the object to which a node is tied. For the world it is `point` itself.
OnSurface nearest_place(WorldState& world, const TiedObjects& objects, std::span<const RigidMotion> pose,
                        const Vec3& point) {
    const Model& model = world.model;
    if (objects.second != no_index) {
        const auto body = static_cast<std::size_t>(objects.second);
        const auto round = model.round_shape(body);
        return round ? on_shape(round->geometry, round->motion, point) : on_triangles(world, objects, body, point);
    }
    if (objects.collider == no_index) return {.point = point, .normal = Vec3::UnitZ()};
    const auto c = static_cast<std::size_t>(objects.collider);
    if (const Index mesh = model.colliders.body[c]; mesh != no_index)
        return on_triangles(world, objects, static_cast<std::size_t>(mesh), point);
    return on_shape(model.colliders.geometry[c], pose[c], point);
}

bool is_deforming(const Model& model, Index body) {
    return body != no_index && !model.is_rigid(static_cast<std::size_t>(body));
}

/// Present positions of the tied points [m], one for each tied node: the position of the node, or for a ball
/// (TieKind::ball) the centre of mass of all tied nodes.
std::vector<Vec3> tied_points(const Model& model, const TiedObjects& objects, const TieSettings& tie) {
    const Index first = model.bodies.nodes[static_cast<std::size_t>(objects.first)].begin;
    std::vector<Vec3> points;
    for (const Index node : tie.nodes) points.push_back(model.nodes.position[first + node]);
    if (tie.kind != TieKind::ball) return points;
    Vec3 sum = Vec3::Zero();
    Real mass = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Real of_node = model.nodes.mass[first + tie.nodes[k]];
        sum += of_node * points[k];
        mass += of_node;
    }
    points.assign(points.size(), sum / mass);
    return points;
}

/// Throws SceneError if a tied point is farther from the surface of the object to which it is tied than the mean edge
/// length of the tied body, or if this object has no surface. Ball ties to objects that do not deform have no limit.
void require_close(WorldState& world, const TiedObjects& objects, std::span<const RigidMotion> pose,
                   const TieSettings& tie, std::span<const Vec3> points) {
    const Model& model = world.model;
    const Real reach = model.bodies.mean_edge[static_cast<std::size_t>(objects.first)];
    const bool is_ball = tie.kind == TieKind::ball;
    const bool anywhere = is_ball && !is_deforming(model, objects.second);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Real distance = (points[k] - nearest_place(world, objects, pose, points[k]).point).norm();
        if (!(distance <= reach) && !anywhere)
            refuse_tie(model, objects, "nodes",
                       (is_ball ? "nodes whose mean point" : "node " + std::to_string(tie.nodes[k]) + ", which") +
                           " is " + short_text(distance) + " m from the surface to which it is tied",
                       "nodes at most " + short_text(reach) + " m from it (the mean edge length of the surface of " +
                           title_of_tied(model, objects.first) + ")");
    }
}

/// Frame of the object to which a node is tied: the mesh frame of a rigid or implicit body, the frame of a collider,
/// else world axes.
RigidPose frame_of(const Model& model, const TiedObjects& objects, std::span<const RigidMotion> pose) {
    if (objects.second != no_index && model.has_frame(static_cast<std::size_t>(objects.second)))
        return pose_of_body(model, static_cast<std::size_t>(objects.second));
    if (objects.collider == no_index) return {Vec3::Zero(), Mat3::Identity()};
    const RigidMotion& of = pose[static_cast<std::size_t>(objects.collider)];
    return {of.position, of.rotation};
}

void append_node(TieTable& table, Index node, const OnSurface& on, const Vec3& rest_point, const Vec3& normal) {
    table.node.push_back(node);
    table.corner.push_back(on.corner);
    table.weight.push_back(on.weight);
    table.place.push_back(rest_point);
    table.normal.push_back(normal);
    table.impulse.push_back(Vec3::Zero());
    table.broken.push_back(infinity);
}

/// Appends a tied node to TieTable. Its `place` is an offset from the nearest surface point if the other object
/// deforms, otherwise a position in the frame of the object (frame_of). `point`: point that is tied, see tied_points()
/// [m].
void tie_node(WorldState& world, const TieSettings& tie, const TiedObjects& objects, std::span<const RigidMotion> pose,
              Index node, const Vec3& point) {
    Model& model = world.model;
    const OnSurface on = nearest_place(world, objects, pose, point);
    const Vec3& target = tie.close_gap ? on.point : point;
    const RigidPose frame = frame_of(model, objects, pose);
    const Mat3 to_frame = frame.rotation.transpose();
    if (!is_deforming(model, objects.second)) {
        append_node(model.ties, node, on, to_frame * (target - frame.position), to_frame * on.normal);
        return;
    }
    const auto second = static_cast<std::size_t>(objects.second);
    Mat3 axes = frame.rotation;
    if (!model.has_frame(second)) {
        const auto at = [&](std::size_t a) -> const Vec3& {
            return model.nodes.position[static_cast<std::size_t>(model.bodies.nodes[second].begin + on.corner[a])];
        };
        axes = triangle_axes({at(0), at(1), at(2)});
    }
    append_node(model.ties, node, on, axes.transpose() * (target - on.point), Vec3::Zero());
}

void wake_tied(Model& model, std::size_t tie) {
    model.wake(static_cast<std::size_t>(model.ties.first[tie]));
    if (model.ties.second[tie] != no_index) model.wake(static_cast<std::size_t>(model.ties.second[tie]));
}

/// True if another tie of the same two objects also switches off their collisions. They then stay off when this tie is
/// removed or breaks.
bool collisions_off_by_another(const TieTable& ties, std::size_t tie) {
    for (std::size_t other = 0; other < ties.size(); ++other) {
        const bool same_pair =
            ties.collider[other] == ties.collider[tie] &&
            std::minmax(ties.first[other], ties.second[other]) == std::minmax(ties.first[tie], ties.second[tie]);
        if (other != tie && ties.parts[other] != 0 && same_pair) return true;
    }
    return false;
}

ColliderHandle handle_of_collider(const Model& model, Index collider) {
    return model.collider_map.handle_of_slot(model.colliders.slot[static_cast<std::size_t>(collider)]);
}

/// Switches the collisions of the two objects of a tie on or off. Returns true if they were on before. Does nothing and
/// returns false for a tie to the world.
bool switch_collisions(World& world, const Model& model, std::size_t tie, bool on) {
    const BodyHandle first = handle_of_body(model, model.ties.first[tie]);
    const auto set = [&](auto other) {
        const bool were_on = world.may_collide(first, other);
        world.set_collision(first, other, on);
        return were_on;
    };
    if (model.ties.second[tie] != no_index) return set(handle_of_body(model, model.ties.second[tie]));
    return model.ties.collider[tie] != no_index && set(handle_of_collider(model, model.ties.collider[tie]));
}

}  // namespace

TieHandle Ties::add(const TieSettings& tie) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("add_tie");
    state.settle();
    Model& model = state.model;
    const TiedObjects objects = objects_of(model, tie);
    validate_nodes(model, objects, tie.nodes);
    validate_break_force(model, objects, tie.break_force);
    const std::vector<RigidMotion> poses = present_poses(state);
    TieTable& table = model.ties;
    const std::vector<Vec3> points = tied_points(model, objects, tie);
    require_close(state, objects, poses, tie, points);
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const TieHandle handle = model.tie_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    table.kind[row] = tie.kind;
    table.first[row] = objects.first;
    table.second[row] = objects.second;
    table.collider[row] = objects.collider;
    table.break_force[row] = tie.break_force;
    table.close_gap[row] = tie.close_gap;
    table.bodies_touch[row] = tie.bodies_touch;
    table.largest_force[row] = table.step[row] = 0;
    const auto begin = static_cast<Index>(table.node.size());
    for (std::size_t k = 0; k < points.size(); ++k) tie_node(state, tie, objects, poses, tie.nodes[k], points[k]);
    table.nodes[row] = {begin, static_cast<Index>(table.node.size())};
    table.parts[row] = 0;
    if (!tie.bodies_touch)
        table.parts[row] = switch_collisions(*world_, model, row, false) || collisions_off_by_another(table, row);
    wake_tied(model, row);
    model.links_open = true;
    return handle;
}

void prepare_removal(World& world, TieHandle tie) {
    const Model& model = WorldAccess::state_of(world).model;
    const auto row = static_cast<std::size_t>(model.tie_map.row(tie));
    if (model.ties.parts[row] != 0 && !collisions_off_by_another(model.ties, row))
        switch_collisions(world, model, row, true);
}

void release_ties(WorldState& world) {
    TieTable& ties = world.model.ties;
    world.model.links_open = true;
    note_changed_seams(world.model);
    for (std::size_t t = 0; t < ties.size(); ++t) {
        if (ties.parts[t] == 0 || ties.holds(t)) continue;
        ties.parts[t] = 0;
        if (collisions_off_by_another(ties, t)) continue;
        const bool of_collider = ties.collider[t] != no_index;
        if (!of_collider && ties.second[t] == no_index) continue;
        const PairKind kind = of_collider ? PairKind::collider : PairKind::bodies;
        const Index second = of_collider ? ties.collider[t] : ties.second[t];
        enable_pair(world, kind, ties.first[t], second);
        if (world.ranks.on())
            world.ranks.enabled_pairs.push_back(
                pair_key(world.model.bodies, world.model.colliders, kind, ties.first[t], second));
    }
}

TieState Ties::state(TieHandle tie) const {
    return tie_state(WorldAccess::state_of(*world_), tie);
}

TieState tie_state(const WorldState& world, TieHandle tie) {
    const Model& model = world.model;
    const auto t = static_cast<std::size_t>(model.row(tie, "tie"));
    const TieTable& table = model.ties;
    TieInputs inputs =
        TieInputs::bind({}, table, model.bodies, model.nodes, model.rigid_bodies, model.colliders, model.any_asleep);
    const std::vector<RigidMotion> poses = present_poses(world);
    inputs.motion = poses;
    TieState now;
    now.kind = table.kind[t];
    now.body = handle_of_body(model, table.first[t]);
    if (table.second[t] != no_index) now.to_body = handle_of_body(model, table.second[t]);
    if (table.collider[t] != no_index) now.to_collider = handle_of_collider(model, table.collider[t]);
    now.break_force = table.break_force[t];
    now.largest_force = table.largest_force[t];
    const auto position = [&](std::size_t k) -> const Vec3& {
        return model.nodes.position[static_cast<std::size_t>(inputs.row_of(table.first[t], table.node[k]))];
    };
    const Range nodes = table.nodes[t];
    const bool is_ball = now.kind == TieKind::ball;
    if (is_ball) now.point = inputs.mean_point(t);
    for (Index k = nodes.begin; k < nodes.end && !is_ball; ++k)
        now.point += position(static_cast<std::size_t>(k)) / static_cast<Real>(nodes.size());
    for (Index row = nodes.begin; row < nodes.end; ++row) {
        const auto k = static_cast<std::size_t>(row);
        TiedNode& node = now.nodes.emplace_back();
        node.node = table.node[k];
        if (table.step[t] > 0) node.force = table.impulse[k] / table.step[t];
        if (table.broken[k] < infinity) node.broken = table.broken[k];
        const TieTarget target = inputs.target(t, k);
        const Vec3 separation = (is_ball ? now.point : position(k)) - target.point;
        node.error = now.kind == TieKind::slide ? std::abs(target.normal.dot(separation)) : separation.norm();
        now.force += node.force;
        now.moment += (position(k) - now.point).cross(node.force);
        if (!node.broken) now.error = std::max(now.error, node.error);
    }
    return now;
}

TieSettings Ties::settings(TieHandle tie) const {
    const Model& model = WorldAccess::state_of(*world_).model;
    const TieTable& table = model.ties;
    const auto row = static_cast<std::size_t>(model.row(tie, "settings"));
    TieSettings settings{.kind = table.kind[row],
                         .body = handle_of_body(model, table.first[row]),
                         .break_force = table.break_force[row],
                         .close_gap = table.close_gap[row] != 0,
                         .bodies_touch = table.bodies_touch[row] != 0};
    if (table.second[row] != no_index) settings.to_body = handle_of_body(model, table.second[row]);
    if (table.collider[row] != no_index) settings.to_collider = handle_of_collider(model, table.collider[row]);
    const std::span<const Index> nodes = rows_of(table.node.span(), table.nodes[row]);
    settings.nodes.assign(nodes.begin(), nodes.end());
    return settings;
}

void Ties::set_break_force(TieHandle tie, Real force) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_break_force");
    Model& model = state.model;
    TieTable& table = model.ties;
    const auto row = static_cast<std::size_t>(model.row(tie, "set_break_force"));
    validate_break_force(model, {table.first[row], table.second[row], table.collider[row]}, force);
    if (table.break_force[row] == force) return;
    table.break_force[row] = force;
    wake_tied(model, row);
}

}  // namespace skerry
