// Resolves the names of anchors, and converts their positions to the world.
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

}  // namespace skerry
