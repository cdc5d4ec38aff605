// The kick of symplectic Euler: sums forces at the nodes and changes velocities by them.
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/element_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "components/ragged.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct KickInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    // Columns of ElementPatches:
    RaggedView<Index> slots_of_node;
    std::span<const PaddedVec3> patch_force;
    std::span<const Real> mass, inverse_mass;
    Vec3 gravity = Vec3::Zero();
    std::span<const Vec3> load = {};                 // applied force; empty: no node has one [N]
    std::span<const std::uint8_t> body_asleep = {};  // BodyTable; nodes at rest are skipped; empty: no body rests
    // BodyTable; elements exert no force on nodes of unstrained bodies; empty: no body is unstrained
    std::span<const std::uint16_t> body_unstrained = {};

    /// `forced`: the world has force elements. `any_asleep`: some body rests.
    static KickInputs bind(const Binder& binder, const NodeBlockTable& block, const ElementPatches& patches,
                           const NodeTable& node, const BodyTable& body, const Vec3& gravity, const bool& forced,
                           const bool& any_asleep) {
        return {.block_begin = binder.read(block.begin),
                .block_end = binder.read(block.end),
                .block_body = binder.read(block.body),
                .slots_of_node = binder.read(patches.slots_of_node),
                .patch_force = binder.read(patches.force),
                .mass = binder.read(node.mass),
                .inverse_mass = binder.read(node.inverse_mass),
                .gravity = binder.value(gravity),
                .load = binder.read_if(binder.value(forced), node.applied_force),
                .body_asleep = binder.read_if(binder.value(any_asleep), body.asleep),
                .body_unstrained = binder.read(body.unstrained)};
    }
};

/// velocity_next = velocity + kick F inverse_mass. `kick`: time for which forces act in this step [s]. F = sum of the
/// forces of the patches around the node, in a fixed order, + mass gravity + load. Nodes without degrees of freedom
/// (inverse mass 0) keep their velocity; for them alone F is written to `force`, and the force that holds them is its
/// opposite. All is done in one pass: storing F of all nodes and reading it again takes as long as the kick itself.
/// Nodes of an unstrained body without loads and held nodes keep bitwise equal velocities. Parallel over node blocks.
void predict_velocity(Executor& executor, const KickInputs& nodes, std::span<const Vec3> velocity, Real kick,
                      std::span<Vec3> force, std::span<Vec3> velocity_next);

}  // namespace skerry
