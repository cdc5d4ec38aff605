// Damping that preserves momentum and angular momentum of bodies without pinned nodes (docs/methods/time_stepping.md
// 3.1).
#pragma once

#include <cstdint>
#include <span>

#include "components/body_table.h"
#include "components/ghost_marks.h"
#include "components/material_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

struct DampingInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    std::span<const Range> body_node_blocks;                    // BodyTable
    std::span<const Index> body_material;                       // BodyTable
    std::span<const Index> body_pinned_count;                   // BodyTable
    std::span<const Range> body_rigid;                          // BodyTable
    std::span<const std::uint8_t> body_idle;                    // BodyTable; empty if no body is idle
    std::span<const std::uint16_t> body_unstrained;             // BodyTable
    std::span<const Real> material_damping;                     // [1/s]
    std::span<const Vec3> position;
    std::span<const Real> mass, inverse_mass;
    Real lag = 0;  // time by which velocities are earlier than positions [s]
    GhostMarks ghosts = {};

    static DampingInputs bind(const Binder& binder, const NodeBlockTable& block, const BodyTable& body,
                              const MaterialTable& material, const NodeTable& node, const Real& lag,
                              const bool& any_idle) {
        return {.block_begin = binder.read(block.begin),
                .block_end = binder.read(block.end),
                .block_body = binder.read(block.body),
                .body_node_blocks = binder.read(body.node_blocks),
                .body_material = binder.read(body.material),
                .body_pinned_count = binder.read(body.pinned_count),
                .body_rigid = binder.read(body.rigid),
                .body_idle = binder.read_if(binder.value(any_idle), body.idle),
                .body_unstrained = binder.read(body.unstrained),
                .material_damping = binder.read(material.damping),
                .position = binder.read(node.position),
                .mass = binder.read(node.mass),
                .inverse_mass = binder.read(node.inverse_mass),
                .lag = binder.value(lag),
                .ghosts = {binder.read(body.ghost)}};
    }
};

/// Damps the deformation of bodies with damping > 0 (docs/methods/time_stepping.md 3.1): removes the fraction
/// 1 - exp(-damping kick) of v - v_rigid from velocity_next. Left out are bodies in RigidBodyTable, idle bodies, and
/// bodies in unstrained flight (translation without strain). Parallel over node blocks; sums in block order.
/// - v: `velocity`, at the start of the step. The predicted velocity would not do: under load it is not zero even for a
///   body at rest, on which damping must not act.
/// - v_rigid: rigid motion with the momentum and angular momentum of the body; zero for a body with pinned nodes. It is
///   taken at the node positions DampingInputs::lag ago, to which v belongs, so that steady rotation is not damped. The
///   moment arms are the present positions, so that damping leaves the angular momentum there unchanged.
/// - `kick`: time between `velocity` and velocity_next [s].
/// - `dissipated`: removed kinetic energy [J], without that of ghosts (copies of bodies of other ranks).
///
/// Returns false if no body has damping (skipped).
bool damp_velocity(Executor& executor, const DampingInputs& bodies, std::span<const Vec3> velocity, Real kick,
                   std::span<NodeBlockSums> sums, std::span<Vec3> velocity_next, Real& dissipated);

}  // namespace skerry
