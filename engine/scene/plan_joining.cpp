// Finds the objects that ties, cables, springs and their anchors name, and converts points of anchors to world
// coordinates.
#include "engine/scene/scene_plan.h"
#include "systems/geometry/rotation.h"

namespace skerry {

AnchorPlan plan_anchor(const AnchorEntry& entry, const ScenePlan& plan) {
    AnchorPlan anchor{.point = entry.point};
    if (entry.body) anchor.body = find_body(plan, *entry.body, entry.place.key("body"));
    if (entry.collider) anchor.collider = find_collider(plan, *entry.collider, entry.place.key("collider"));
    return anchor;
}

Anchor anchor_of(const AnchorPlan& anchor, const ScenePlan& plan, const World& world, const PlannedHandles& handles) {
    Anchor built{.point = anchor.point};
    if (anchor.body) {
        const BodySettings& body = plan.bodies[*anchor.body].settings;
        built.body = handles.bodies[*anchor.body];
        built.point = body.position + rotation_matrix(body.rotation) * anchor.point;
    }
    if (anchor.collider) {
        built.collider = handles.colliders[*anchor.collider];
        const MotionKey pose = world.pose(*built.collider);
        built.point = pose.position + rotation_matrix(pose.rotation) * anchor.point;
    }
    return built;
}

TiePlan plan_tie(const TieEntry& entry, const ScenePlan& plan) {
    TiePlan tie;
    tie.name = choose_name(entry.name, names_of(plan.ties), "tie", entry.place);
    tie.body = find_body(plan, entry.body, entry.place.key("body"));
    if (entry.to_body) tie.to_body = find_body(plan, *entry.to_body, entry.place.key("to_body"));
    if (entry.to_collider) tie.to_collider = find_collider(plan, *entry.to_collider, entry.place.key("to_collider"));
    tie.settings.kind = entry.kind;
    tie.settings.nodes = nodes_of(entry, plan.bodies[tie.body], plan);
    if (entry.break_force) tie.settings.break_force = *entry.break_force;
    tie.settings.close_gap = entry.close_gap;
    tie.settings.bodies_touch = entry.bodies_touch;
    tie.place = entry.place;
    return tie;
}

CablePlan plan_cable(const CableEntry& entry, const ScenePlan& plan) {
    CablePlan cable{.name = choose_name(entry.name, names_of(plan.cables), "cable", entry.place)};
    for (const AnchorEntry& point : entry.points) cable.points.push_back(plan_anchor(point, plan));
    cable.settings.drive = {.tension = entry.tension, .length = entry.length, .rate = entry.rate};
    cable.settings.friction = entry.friction;
    cable.place = entry.place;
    return cable;
}

SpringPlan plan_spring(const SpringEntry& entry, const ScenePlan& plan) {
    SpringPlan spring;
    spring.name = choose_name(entry.name, names_of(plan.springs), "spring", entry.place);
    spring.first = plan_anchor(entry.first, plan);
    spring.second = plan_anchor(entry.second, plan);
    spring.settings.stiffness = entry.stiffness;
    spring.settings.damping = entry.damping;
    spring.settings.rest_length = entry.rest_length;
    spring.settings.only = entry.only;
    spring.settings.strength = entry.strength.value_or(infinity);
    spring.place = entry.place;
    return spring;
}

}  // namespace skerry
