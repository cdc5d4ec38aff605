#include "systems/collision/inputs/contact_reach.h"

#include <algorithm>
#include <cmath>

namespace skerry {

namespace {

SurfaceProperties surface_of_body(const CollisionInputs& inputs, Index body) {
    return with_given(inputs.material_surface[inputs.body.material[body]], inputs.body.surface[body]);
}

}  // namespace

SurfaceProperties with_given(SurfaceProperties properties, const SurfaceProperties& given) {
    if (given.static_friction >= 0) properties.static_friction = given.static_friction;
    if (given.dynamic_friction >= 0) properties.dynamic_friction = given.dynamic_friction;
    if (given.restitution >= 0) properties.restitution = given.restitution;
    return properties;
}

PairScale pair_scale(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    const BodyTable& body = inputs.body;
    PairScale scale;
    const Real own_distance = body.contact_distance[first];
    const Real own_edge = body.mean_edge[first];
    if (kind == PairKind::collider) {
        // The signed distance from a collider is exact at any depth inside it. The zone therefore needs no margin for
        // points of the body inside the collider, and edge_depth is 0. face_depth is for points of the collider inside
        // the body.
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

PartnerSurface partner_surface(const CollisionInputs& inputs, Index body, Index collider) {
    if (collider == no_index && inputs.body.kind[body] == BodyKind::kinematic) collider = inputs.body.collider[body];
    if (collider == no_index) return {inputs.body.material[body], surface_of_body(inputs, body)};
    const Index material = inputs.collider.material[collider];
    const SurfaceProperties of_material =
        material == no_index ? SurfaceProperties{} : inputs.material_surface[material];
    return {material, with_given(of_material, inputs.collider.surface[collider])};
}

SurfaceProperties mean_surface(const SurfaceProperties& own, const SurfaceProperties& partner) {
    const SurfaceProperties other = with_given(own, partner);
    return {std::sqrt(own.static_friction * other.static_friction),
            std::sqrt(own.dynamic_friction * other.dynamic_friction), std::max(own.restitution, other.restitution)};
}

SurfaceProperties pair_surface(const CollisionInputs& inputs, PairKind kind, Index first, Index second) {
    const PartnerSurface own = partner_surface(inputs, first, no_index),
                         other = kind == PairKind::collider ? partner_surface(inputs, no_index, second)
                                                            : partner_surface(inputs, second, no_index);
    const SurfaceProperties mean = mean_surface(own.surface, other.surface);
    if (inputs.material_pairs == nullptr || inputs.material_pairs->size() == 0) return mean;
    const MaterialPairTable& pairs = *inputs.material_pairs;
    const std::size_t row = pairs.place_of(own.material, other.material);
    return pairs.is_pair(row, own.material, other.material) ? with_given(mean, pairs.surface[row]) : mean;
}

}  // namespace skerry
