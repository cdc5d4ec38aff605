#include "systems/collision/inputs/contact_reach.h"

#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

/// Returns `properties` with each property replaced by the one in `given` if that is not negative.
SurfaceProperties with_given(SurfaceProperties properties, const SurfaceProperties& given) {
    if (given.static_friction >= 0) properties.static_friction = given.static_friction;
    if (given.dynamic_friction >= 0) properties.dynamic_friction = given.dynamic_friction;
    if (given.restitution >= 0) properties.restitution = given.restitution;
    return properties;
}

SurfaceProperties surface_of_body(const CollisionInputs& inputs, Index body) {
    return with_given(inputs.material_surface[inputs.body.material[body]], inputs.body.surface[body]);
}

}  // namespace

PairScale pair_scale(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    const BodyTable& body = inputs.body;
    PairScale scale;
    const Real own_distance = body.contact_distance[first];
    const Real own_edge = body.mean_edge[first];
    if (kind == PairKind::collider) {
        // The signed distance from the collider is valid at any depth, so the zone needs no margin for points of the
        // body inside the collider. face_depth is needed for points of the collider inside the body.
        const Real half = own_distance / 2, radius = body.round_radius[first], kept = half + radius;
        return {kept, half, own_edge, face_depth_fraction * own_edge, 0, kept, radius};
    }
    scale.shell = (own_distance + body.contact_distance[second]) / 2;
    scale.radii = body.round_radius[first] + body.round_radius[second];
    scale.contact_distance = scale.shell + scale.radii;
    scale.edge = std::min(own_edge, body.mean_edge[second]);
    scale.face_depth = face_depth_fraction * scale.edge;
    scale.edge_depth = std::max(scale.contact_distance, edge_depth_fraction * scale.edge);
    scale.zone = std::max(scale.contact_distance, scale.face_depth);
    return scale;
}

SurfaceProperties pair_surface(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    const SurfaceProperties own = surface_of_body(inputs, first);
    SurfaceProperties other = own;
    if (kind == PairKind::collider || inputs.body.kind[second] == BodyKind::kinematic) {
        const Index collider = kind == PairKind::collider ? second : inputs.body.collider[second];
        other = with_given(own, inputs.collider.surface[collider]);
    } else {
        other = surface_of_body(inputs, second);
    }
    return {std::sqrt(own.static_friction * other.static_friction),
            std::sqrt(own.dynamic_friction * other.dynamic_friction), std::max(own.restitution, other.restitution)};
}

}  // namespace skerry
