#include "engine/world/query/place_anchor.h"

#include <algorithm>

#include "engine/base/complaint.h"
#include "engine/world/query/fitted_tree.h"
#include "engine/world/validate.h"
#include "systems/dynamics/motion/move_colliders.h"
#include "systems/geometry/material_point.h"

namespace skerry {

namespace {

AnchorRow row_of(const MaterialPoint& point) {
    return {point.node, point.weight, Vec3::Zero()};
}

/// Fixes a point, inside or outside of a rigid body, to one tetrahedron of its mesh by barycentric weights. Every
/// tetrahedron that is not flat represents the point exactly. The smallest sum of squared weights gives the smallest
/// rounding errors.
AnchorRow point_of_rigid_body(std::span<const Vec3> nodes, std::span<const std::array<Index, 4>> tetrahedra,
                              const Vec3& point) {
    MaterialPoint best;
    Real smallest = infinity;
    for (const std::array<Index, 4>& corners : tetrahedra) {
        const MaterialPoint found = point_of_tetrahedron(nodes, corners, point);
        Real squares = 0;
        for (const Real weight : found.weight) squares += weight * weight;
        if (!(squares < smallest)) continue;
        smallest = squares;
        best = found;
    }
    return row_of(best);
}

AnchorRow point_of_body(WorldState& world, std::size_t body, const Vec3& point, const std::string& object,
                        const std::string& field) {
    const Model& model = world.model;
    const BodyRecord& record = model.body_records[body];
    const std::span<const Vec3> nodes = rows_of(model.nodes.position, model.bodies.nodes[body]);
    if (model.is_rigid(body)) {
        if (!record.tetrahedra.empty()) return point_of_rigid_body(nodes, record.tetrahedra, point);
        return row_of(point_of_solid(nodes, point));
    }
    if (const std::optional<MaterialPoint> inside = point_inside(nodes, record.tetrahedra, point))
        return row_of(*inside);
    const Real reach = model.bodies.mean_edge[body];
    const std::optional<TrianglePoint> nearest = nearest_point(fitted_tree(world, body), point, infinity);
    if (!nearest || !(nearest->distance <= reach))
        refuse(
            object, field + ".point",
            "a point " + short_text(nearest ? nearest->distance : infinity) + " m outside body '" + record.name + "'",
            "a point in the body, or at most " + short_text(reach) +
                " m outside (the mean edge length of its surface)");
    const Index tetrahedron =
        model.user_tetrahedron(body, model.surface.triangles.element[static_cast<std::size_t>(nearest->triangle)]);
    return row_of(point_of_tetrahedron(nodes, record.tetrahedra[static_cast<std::size_t>(tetrahedron)], point));
}

RigidPose pose_of_collider(const WorldState& world, std::size_t collider) {
    const ColliderTable& table = world.model.colliders;
    return pose_at(table.script[collider], table.keyframe, table.initial[collider], world.clock.time);
}

}  // namespace

void PlacedAnchor::store(AnchorColumns& columns, std::size_t row) const {
    columns.body[row] = body;
    columns.collider[row] = collider;
    columns.point[row] = point;
}

PlacedAnchor place_anchor(WorldState& world, const Anchor& anchor, const std::string& object,
                          const std::string& field) {
    require_finite(object, field + ".point", anchor.point);
    if (anchor.body && anchor.collider)
        refuse(object, field, "a body and a collider", "a body, a collider, or neither for the world");
    PlacedAnchor placed;
    if (anchor.body) {
        placed.body = world.model.row(*anchor.body, object.c_str());
        placed.point = point_of_body(world, static_cast<std::size_t>(placed.body), anchor.point, object, field);
    } else if (anchor.collider) {
        placed.collider = world.model.row(*anchor.collider, object.c_str());
        const RigidPose pose = pose_of_collider(world, static_cast<std::size_t>(placed.collider));
        placed.point.point = pose.rotation.transpose() * (anchor.point - pose.position);
    } else {
        placed.point.point = anchor.point;
    }
    return placed;
}

std::string title_of_end(const Model& model, Index body, Index collider) {
    if (body != no_index) return "body '" + model.body_records[static_cast<std::size_t>(body)].name + "'";
    if (collider == no_index) return "the world";
    return "collider '" + model.collider_records[static_cast<std::size_t>(collider)].name + "'";
}

std::string title_of_end(const Model& model, const Anchor& anchor) {
    const Index body = anchor.body ? model.body_map.row(*anchor.body) : no_index;
    const Index collider = anchor.collider ? model.collider_map.row(*anchor.collider) : no_index;
    if (anchor.body && body == no_index) return "a removed body";
    if (anchor.collider && collider == no_index) return "a removed collider";
    return title_of_end(model, body, collider);
}

AnchorsBetweenSteps::AnchorsBetweenSteps(const WorldState& world) : model_(world.model) {
    const ColliderTable& table = model_.colliders;
    const Real now = world.clock.time, before = world.clock.step_before;
    for (std::size_t c = 0; c < table.slot.size(); ++c) {
        const RigidPose pose = pose_of_collider(world, c);
        RigidMotion motion = table.motion[c];
        if (before > 0)
            motion = motion_of_step(table.script[c], table.keyframe, table.initial[c], now - before, before);
        motion.position = pose.position;
        motion.rotation = pose.rotation;
        motion_.push_back(motion);
    }
}

AnchorInputs AnchorsBetweenSteps::of(const AnchorColumns& columns) const {
    AnchorInputs inputs = AnchorInputs::bind({}, columns, model_.bodies, model_.nodes, model_.colliders);
    inputs.motion = motion_;
    return inputs;
}

Anchor AnchorsBetweenSteps::at(const AnchorColumns& columns, std::size_t row) const {
    Anchor anchor;
    if (const Index body = columns.body[row]; body != no_index)
        anchor.body = model_.body_map.handle_of_slot(model_.bodies.slot[static_cast<std::size_t>(body)]);
    if (const Index collider = columns.collider[row]; collider != no_index)
        anchor.collider = model_.collider_map.handle_of_slot(model_.colliders.slot[static_cast<std::size_t>(collider)]);
    anchor.point = of(columns).at(row);
    return anchor;
}

}  // namespace skerry
