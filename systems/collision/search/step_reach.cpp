#include "systems/collision/search/step_reach.h"

#include <algorithm>
#include <cmath>

#include "systems/collision/inputs/contact_reach.h"

namespace skerry {

namespace {

/// Greatest speed of a point on the surface of a body, relative to a frame with the velocity `frame` [m/s].
Real surface_speed(const CollisionInputs& inputs, Index body, const Vec3& frame) {
    Real squared = 0;
    const Range vertices = inputs.body.vertices[body];
    for (Index v = vertices.begin; v < vertices.end; ++v)
        squared = std::max(squared, (inputs.velocity[inputs.surface.vertices.node[v]] - frame).squaredNorm());
    return std::sqrt(squared);
}

}  // namespace

BodyReach body_reach(const CollisionInputs& inputs, const CollisionSettings& settings, Index body, bool measure,
                     Real h) {
    Real in_frame = inputs.body.frame_speed[body], in_world = inputs.body.max_speed[body];
    const Index collider = inputs.body.collider[body];
    const bool scripted =
        inputs.body.kind[body] == BodyKind::kinematic && !inputs.collider.motion[collider].stands_still();
    if (measure || scripted) {
        in_frame = std::max(in_frame, surface_speed(inputs, body, inputs.body.frame[body].velocity));
        in_world = std::max(in_world, surface_speed(inputs, body, Vec3::Zero()));
    }
    // The reach of a body is used for its pairs with all partners, and a partner may be held in place. So the full
    // gravity is used, although gravity does not change the relative velocity of two bodies that fall freely.
    const auto reach_at = [&](Real speed) {
        return reach(h, speed, settings.gravity, inputs.body.contact_distance[body] / 2);
    };
    return {reach_at(in_frame), reach_at(in_world)};
}

Real frame_reach(const CollisionInputs& inputs, Index first, Index second, Real h) {
    return speed_safety * h * (inputs.body.frame[first].velocity - inputs.body.frame[second].velocity).norm();
}

Real collider_reach(const CollisionInputs& inputs, Index collider, Real extent, Real h) {
    const RigidMotion& motion = inputs.collider.motion[collider];
    const Real turning = motion.angular_velocity.norm();
    return reach(h, motion.velocity.norm() + (turning > 0 ? turning * extent : 0), 0, 0);
}

}  // namespace skerry
