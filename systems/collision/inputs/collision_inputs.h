// What the collision stages read.
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
    std::span<const Vec3> position;            // by node, start of the step
    std::span<const Vec3> velocity;            // by node, start of the step
    std::span<const Vec3> rest_position = {};  // by node; empty: self-contact has no rest shape to compare with
    std::span<const std::uint64_t> disabled_pairs = {};  // ContactKey::pair, ascending

    static CollisionInputs bind(const Binder& binder, const BodyTable& body, const ColliderTable& collider,
                                const SurfaceTables& surface, const MaterialTable& material, const BvhTable& bvh,
                                const BvhLeafTable& bvh_leaf, const NodeTable& node,
                                const DisabledPairTable& disabled) {
        // find_inversions writes its budgets beside find_crossings
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

/// How far apart things are looked at, all in metres or metres per second.
struct CollisionSettings {
    Real gravity = 0;  // m/s^2, norm: how much faster things may become in a step
    // fraction of the mean edge: candidates are kept this much beyond the distance at which they matter
    Real pair_skin = 0.3125;
    Real broad_skin = 4.0;    // fraction of the mean edge: pairs of bodies are kept this much beyond it
    bool use_budgets = true;  // off: search everything in every step (the simple twin, for tests)
    bool continuous = true;   // off: the motion of a step is not looked at for crossings
};

}  // namespace skerry
