#include "engine/estimate/contact_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

#include "engine/world/world_state.h"

namespace skerry {

namespace {

// Upper limit of the angle between the normal of a node and that of a face at this node [rad]. Beyond it, the node lies
// on an edge or corner of the body. The angle is pi/4 at an edge of a box, and at nodes of a coarse ball about half of
// the angle between neighbouring faces.
constexpr Real sharp = 0.7;
// A contact counts as flat if the sum of both curvatures times the mean edge length is below this value.
constexpr Real flat = 1e-3;

/// Mean curvature of a sphere, or of the cylindrical part of a capsule; 0 for other shapes, which are flat or have
/// sharp edges [1/m].
Real curvature_of(const ColliderGeometry& geometry) {
    if (geometry.shape == ColliderShape::sphere) return 1 / geometry.size.x();
    return geometry.shape == ColliderShape::capsule ? 1 / (2 * geometry.size.x()) : 0;
}

/// Summand of a body in the compliance of Hertz, 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2; 0 for rigid bodies and
/// colliders [1/Pa].
Real compliance_of(const World& world, BodyHandle body) {
    if (!world.alive(body) || world.dynamics(body) == BodyDynamics::rigid) return 0;
    const MaterialSettings material = world.material(world.material(body));
    return (1 - material.poisson_ratio * material.poisson_ratio) / material.young_modulus;
}

/// Mean of a quantity over the nodes of one side of a contact, weighted by the weights of the contact point. `of_node`:
/// values by node of the body. Weights are positive for the nodes of the first side.
Real mean_of_nodes(const Contact& contact, bool first, std::span<const Real> of_node) {
    Real sum = 0;
    for (std::size_t k = 0; k < contact.node.size(); ++k)
        if (contact.node[k] >= 0 && (contact.weight[k] > 0) == first)
            sum += std::abs(contact.weight[k]) * of_node[static_cast<std::size_t>(contact.node[k])];
    return sum;
}

/// Sums over the contacts of a body with one other object: of the force, of force times curvature, and of force times
/// edge length.
struct Patch {
    Real force = 0;                // [N]
    Real curvature = 0, edge = 0;  // [N/m, N m]
    Real sharpest = 0;             // largest normal_deviation_at() of a contact [rad]
};

}  // namespace

const ContactArea::Surface& ContactArea::surface_of(const World& world, BodyHandle body) {
    const auto [place, is_new] = surfaces_.try_emplace(body);
    Surface& surface = place->second;
    if (!is_new) return surface;
    const Model& model = WorldAccess::state_of(world).model;
    const auto row = static_cast<std::size_t>(model.row(body, "sample"));
    const std::span<const Vec3> rest = rows_of(model.nodes.rest_position, model.bodies.nodes[row]);
    const auto at = [&](Index n) { return rest[static_cast<std::size_t>(n)]; };
    std::vector<Vec3> normal(rest.size(), Vec3::Zero());
    for (const auto& [a, b, c] : world.surface(body)) {
        const Vec3 area = (at(b) - at(a)).cross(at(c) - at(a));
        for (const Index n : {a, b, c}) normal[static_cast<std::size_t>(n)] += area;
    }
    surface.curvature.assign(rest.size(), 0);
    surface.edge.assign(rest.size(), 0);
    std::vector<int> edges(rest.size(), 0);
    for (const std::array<Index, 3>& triangle : world.surface(body))
        for (std::size_t k = 0; k < 3; ++k)
            for (const Index other : {triangle[(k + 1) % 3], triangle[(k + 2) % 3]}) {
                const auto n = static_cast<std::size_t>(triangle[k]);
                const Vec3 edge = rest[n] - at(other);
                surface.curvature[n] += 2 * normal[n].normalized().dot(edge) / edge.squaredNorm();
                surface.edge[n] += edge.norm();
                ++edges[n];
            }
    surface.normal_deviation.assign(rest.size(), 0);
    for (const auto& [a, b, c] : world.surface(body)) {
        const Vec3 of_face = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
        for (const Index node : {a, b, c}) {
            const auto n = static_cast<std::size_t>(node);
            const Real cosine = std::clamp(of_face.dot(normal[n].normalized()), Real{-1}, Real{1});
            surface.normal_deviation[n] = std::max(surface.normal_deviation[n], std::acos(cosine));
        }
    }
    for (std::size_t n = 0; n < rest.size(); ++n) {
        if (edges[n] == 0) continue;
        surface.curvature[n] /= edges[n];
        surface.edge[n] /= edges[n];
    }
    return surface;
}

/// Mean curvature of the surface of a body or collider at a contact [1/m]. `first`: true for the first body of the
/// contact.
Real ContactArea::curvature_at(const World& world, const Contact& contact, bool first) {
    const Model& model = WorldAccess::state_of(world).model;
    const BodyHandle body = first ? contact.first : contact.second;
    if (!world.alive(body)) {
        const auto row = static_cast<std::size_t>(model.row(contact.collider, "sample"));
        return curvature_of(model.colliders.geometry[row]);
    }
    if (const auto round = model.round_shape(static_cast<std::size_t>(model.row(body, "sample"))))
        return curvature_of(round->geometry);
    const Surface& surface = surface_of(world, body);
    return mean_of_nodes(contact, first, surface.curvature);
}

/// Surface::normal_deviation interpolated at a contact point; 0 for colliders and round bodies [rad].
Real ContactArea::normal_deviation_at(const World& world, const Contact& contact, bool first) {
    const Model& model = WorldAccess::state_of(world).model;
    const BodyHandle body = first ? contact.first : contact.second;
    if (!world.alive(body) || model.round_shape(static_cast<std::size_t>(model.row(body, "sample")))) return 0;
    return mean_of_nodes(contact, first, surface_of(world, body).normal_deviation);
}

void ContactArea::sample(const World& world) {
    std::map<std::tuple<BodyHandle, BodyHandle, ColliderHandle>, Patch> patches;
    for (const Contact& contact : world.contacts()) {
        const Real force = contact.force().norm();
        if (contact.region < 0 || !(force > 0)) continue;
        const Real curvature = curvature_at(world, contact, true) + curvature_at(world, contact, false);
        const Real deviation =
            std::max(normal_deviation_at(world, contact, true), normal_deviation_at(world, contact, false));
        for (const bool first : {true, false}) {
            const BodyHandle body = first ? contact.first : contact.second;
            if (!world.alive(body) || world.dynamics(body) == BodyDynamics::rigid) continue;
            Patch& patch = patches[{body, first ? contact.second : contact.first, contact.collider}];
            patch.force += force;
            patch.curvature += force * curvature;
            const Real edge = mean_of_nodes(contact, first, surface_of(world, body).edge);
            patch.edge += force * edge;
            patch.sharpest = std::max(patch.sharpest, deviation);
        }
    }
    for (const auto& [objects, patch] : patches) {
        const auto& [body, other, collider] = objects;
        const Real edge = patch.edge / patch.force, radius = patch.force / patch.curvature;
        Area& area = areas_[body];
        if (!(patch.force > area.force) || patch.sharpest > sharp || !(edge / radius > flat)) continue;
        const Real compliance = compliance_of(world, body) + compliance_of(world, other);
        area = {patch.force, std::cbrt(0.75 * patch.force * radius * compliance), edge};
    }
}

void ContactArea::add_to(std::vector<ErrorEstimate>& bodies) const {
    for (ErrorEstimate& estimate : bodies) {
        const auto area = areas_.find(estimate.body);
        if (area == areas_.end() || !(area->second.force > 0)) continue;
        estimate.contact_radius = area->second.radius;
        estimate.contact_edge = area->second.edge;
    }
}

}  // namespace skerry
