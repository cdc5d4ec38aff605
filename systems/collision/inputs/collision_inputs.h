// Inputs of the collision stages.
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/collider_table.h"
#include "components/collision_filter.h"
#include "components/material_table.h"
#include "components/node_table.h"
#include "components/surface_table.h"
#include "jobs/access.h"

namespace skerry {

struct CollisionInputs {
    const BodyTable& body;
    const ColliderTable& collider;
    const SurfaceTables& surface;
    std::span<const Real> inverse_mass;                   // by node
    std::span<const SurfaceProperties> material_surface;  // by material
    std::span<const BvhNode> bvh_node;
    std::span<const LeafTriangles> leaf_triangle;
    std::span<const LeafNodes> leaf_nodes;
    std::span<const LeafFeatures> leaf_features;
    std::span<const Vec3> position;            // by node, at the start of the step [m]
    std::span<const Vec3> velocity;            // by node, at the start of the step [m/s]
    std::span<const Vec3> rest_position = {};  // by node [m]; if empty, self-contact has no rest shape to compare with
    std::span<const std::uint64_t> disabled_pairs = {};  // ContactKey::pair, ascending

    static CollisionInputs bind(const Binder& binder, const BodyTable& body, const ColliderTable& collider,
                                const SurfaceTables& surface, const MaterialTable& material, const BvhTable& bvh,
                                const BvhLeafTable& bvh_leaf, const NodeTable& node,
                                const DisabledPairTable& disabled) {
        // uninverted_until is excluded, because find_inversions writes it in parallel with find_crossings
        return {.body = binder.read_but(body, body.uninverted_until),
                .collider = binder.read(collider),
                .surface = binder.read(surface),
                .inverse_mass = binder.read(node.inverse_mass),
                .material_surface = binder.read(material.surface),
                .bvh_node = binder.read(bvh.node),
                .leaf_triangle = binder.read(bvh_leaf.triangle),
                .leaf_nodes = binder.read(bvh_leaf.nodes),
                .leaf_features = binder.read(bvh_leaf.features),
                .position = binder.read(node.position),
                .velocity = binder.read(node.velocity),
                .rest_position = binder.read(node.rest_position),
                .disabled_pairs = binder.read(disabled.key)};
    }
};

/// Settings of the collision stages.
struct CollisionSettings {
    Real gravity = 0;  // norm of the gravity; bounds how much faster a body can become in a step [m/s^2]
    // Candidates are kept up to this distance beyond the distance at which they matter, as a fraction of the mean edge
    // length.
    Real pair_skin = 0.3125;
    // Pairs of bodies are kept up to this distance beyond the distance at which they matter, as a fraction of the mean
    // edge length.
    Real broad_skin = 4.0;
    bool use_budgets = true;  // false: every step searches all pairs and features (reference for tests)
    bool continuous = true;   // false: the motion of a step is not tested for crossings
};

}  // namespace skerry
