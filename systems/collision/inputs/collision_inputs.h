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
#include "components/surface_rules.h"
#include "components/surface_table.h"
#include "jobs/access.h"

namespace skerry {

/// Division of the pairs among MPI ranks. Each pair belongs to the rank that owns a certain one of its bodies
/// (belongs_to_second).
struct PairOwners {
    std::span<const std::int32_t> body_owner{};  // by row of BodyTable: owner; empty: this rank has all pairs
    std::int32_t rank = 0;                       // number of this rank

    /// True if a pair of two bodies that can move belongs to the rank of the second body. The pair belongs to the rank
    /// of the body with the higher slot if the sum of the slots is odd, else to that of the other body. So the order of
    /// the bodies has no effect, and each of two ranks gets about half of their common pairs.
    static constexpr bool belongs_to_second(std::uint32_t first_slot, std::uint32_t second_slot) {
        return (first_slot + second_slot) % 2 == (first_slot < second_slot);
    }
    /// True if the pair belongs to this rank. `first`: row of a body that can move. `second`: row of the second body if
    /// it can move, else no_index.
    bool owns(const BodyTable& body, Index first, Index second) const {
        if (body_owner.empty()) return true;
        if (second != no_index && belongs_to_second(body.slot[first], body.slot[second])) first = second;
        return body_owner[first] == rank;
    }
};

struct CollisionInputs {
    const BodyTable& body;
    const ColliderTable& collider;
    const SurfaceTables& surface;
    std::span<const Real> inverse_mass;                   // inverse mass by node [1/kg]
    std::span<const SurfaceProperties> material_surface;  // surface properties by material
    std::span<const BvhNode> bvh_node;
    std::span<const LeafTriangles> leaf_triangle;
    std::span<const LeafNodes> leaf_nodes;
    std::span<const LeafFeatures> leaf_features;
    std::span<const Vec3> position;  // position of each node at the start of the step [m]
    std::span<const Vec3> velocity;  // velocity of each node at the start of the step [m/s]
    // Position of each node in the rest shape [m]. Features of one body that are near each other at rest make no
    // contact; if the span is empty, this is not tested.
    std::span<const Vec3> rest_position = {};
    std::span<const std::uint64_t> disabled_pairs = {};  // keys of the disabled pairs (ContactKey::pair), ascending
    const MaterialPairTable* material_pairs = nullptr;   // null: no pair of materials has its own properties
    PairOwners owners{};                                 // by default all pairs belong to this rank

    static CollisionInputs bind(const Binder& binder, const BodyTable& body, const ColliderTable& collider,
                                const SurfaceTables& surface, const MaterialTable& material, const BvhTable& bvh,
                                const BvhLeafTable& bvh_leaf, const NodeTable& node, const DisabledPairTable& disabled,
                                const MaterialPairTable& material_pairs) {
        // The column uninverted_until is excluded, because find_inversions writes it while find_crossings runs.
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
                .disabled_pairs = binder.read(disabled.key),
                .material_pairs = &binder.read(material_pairs)};
    }
    static CollisionInputs bind(const Binder& binder, const BodyTable& body, const ColliderTable& collider,
                                const SurfaceTables& surface, const MaterialTable& material, const BvhTable& bvh,
                                const BvhLeafTable& bvh_leaf, const NodeTable& node, const DisabledPairTable& disabled,
                                const MaterialPairTable& material_pairs, const Column<std::int32_t>& owner,
                                const int& rank) {
        CollisionInputs inputs =
            bind(binder, body, collider, surface, material, bvh, bvh_leaf, node, disabled, material_pairs);
        inputs.owners = {binder.read(owner), binder.value(rank)};
        return inputs;
    }
};

struct CollisionSettings {
    // Magnitude of the gravitational acceleration [m/s^2]. Bounds of speeds assume that it accelerates each body during
    // the step.
    Real gravity = 0;
    // Least margin m of the candidate lists, as a fraction of the mean edge length. Features are listed as candidates
    // if their distance is below zone + m (contact_reach.h).
    Real pair_skin = 0.3125;
    // Margin of the list of pairs, as a fraction of the mean edge length. Two objects are listed if their boxes overlap
    // when each is enlarged by half of this margin (contact_reach.h, 6).
    Real broad_skin = 4.0;
    bool use_budgets = true;  // false: every step searches all pairs and tests all candidates (reference for tests)
    bool continuous = true;   // false: crossings of surfaces within a step are not detected
};

}  // namespace skerry
