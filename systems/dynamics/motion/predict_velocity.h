// Kick of symplectic Euler: sums the forces on each node and changes the velocity of the node accordingly.
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
    // `slots_of_node`, `patch_force`: columns of ElementPatches. `mass`, `inverse_mass`: columns of NodeTable.
    RaggedView<Index> slots_of_node;
    std::span<const PaddedVec3> patch_force;
    std::span<const Real> mass, inverse_mass;
    Vec3 gravity = Vec3::Zero();
    std::span<const Vec3> load = {};  // applied force; empty if no node has one [N]
    // Column of BodyTable; empty if no body is idle. Idle bodies (asleep, or led by another rank) are skipped.
    std::span<const std::uint8_t> body_idle = {};
    // Column of BodyTable: nonzero for an unstrained body (in translation without strain), whose elements exert no
    // force. Empty if no body is unstrained.
    std::span<const std::uint16_t> body_unstrained = {};

    /// `forced`: true if the world has force elements. `any_idle`: true if some body is idle.
    static KickInputs bind(const Binder& binder, const NodeBlockTable& block, const ElementPatches& patches,
                           const NodeTable& node, const BodyTable& body, const Vec3& gravity, const bool& forced,
                           const bool& any_idle) {
        return {.block_begin = binder.read(block.begin),
                .block_end = binder.read(block.end),
                .block_body = binder.read(block.body),
                .slots_of_node = binder.read(patches.slots_of_node),
                .patch_force = binder.read(patches.force),
                .mass = binder.read(node.mass),
                .inverse_mass = binder.read(node.inverse_mass),
                .gravity = binder.value(gravity),
                .load = binder.read_if(binder.value(forced), node.applied_force),
                .body_idle = binder.read_if(binder.value(any_idle), body.idle),
                .body_unstrained = binder.read(body.unstrained)};
    }
};

/// Sets velocity_next = velocity + kick F inverse_mass. The force F on a node is the sum of the forces of its element
/// patches, in a fixed order, plus mass times gravity plus load. Parallel over node blocks.
/// - `kick`: time for which forces act in this step [s].
/// - Held nodes (inverse mass 0) keep their velocity. `force` receives F for them only; the holding force is the
///   opposite of F. To store F of all nodes and read it again would take as long as the update.
/// - If all nodes of an unstrained body without loads and held nodes have one velocity, their new velocities are
///   bitwise equal too (find_unstrained.h).
void predict_velocity(Executor& executor, const KickInputs& nodes, std::span<const Vec3> velocity, Real kick,
                      std::span<Vec3> force, std::span<Vec3> velocity_next);

}  // namespace skerry
