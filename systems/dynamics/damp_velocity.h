// Damping that keeps momentum and angular momentum (methods.md 4.2).
#pragma once

#include <span>

#include "components/body_table.h"
#include "components/material_table.h"
#include "components/node_block_table.h"
#include "jobs/executor.h"

namespace skerry {

struct DampingInputs {
    std::span<const Index> block_begin, block_end, block_body;  // NodeBlockTable
    std::span<const Range> body_node_blocks;                    // BodyTable
    std::span<const Index> body_material;                       // BodyTable
    std::span<const Index> body_pinned_count;                   // BodyTable
    std::span<const Real> material_damping;                     // 1/s
    std::span<const Vec3> position;
    std::span<const Real> mass, inverse_mass;
    Real lag = 0;  // s, by which velocities are earlier than positions
};

/// Takes (1 - exp(-damping h)) of the deformation velocity v - v_rigid out of velocity_next, for every body with damping > 0. `velocity`
/// is that at the start of the step, not the predicted one: a body at rest under load must not feel its damping. v_rigid is the rigid motion,
/// of the places that the nodes had `lag` ago, with the momentum and the angular momentum of the body; a body with pinned nodes is damped
/// towards rest. With places and velocities of one time a body that turns at its centrifugal stretch has no deformation velocity, and by
/// taking moments about the places of now what is taken out has no angular momentum there. `dissipated` (J) is the kinetic
/// energy taken. Returns false when no body has damping (skipped). Parallel over node blocks; sums in block order.
bool damp_velocity(Executor& executor, const DampingInputs& bodies, std::span<const Vec3> velocity, Real h, std::span<NodeBlockSums> sums,
                   std::span<Vec3> velocity_next, Real& dissipated);

}  // namespace skerry
