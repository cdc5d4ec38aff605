// Moves what overlaps apart where it touches rigid bodies (docs/methods/contact.md 3.4).
#pragma once

#include "systems/solver/operators/freedom_operator.h"
#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// A region with its part of the memory. Rows of its velocities: two a rigid body, then nodes of those that deform,
/// then nodes of clusters, then others.
struct FreedomRegion {
    std::span<const Index> row;    // of its contacts
    std::span<const Index> joint;  // rows of JointBlockTable, which come behind the contacts
    std::span<const Index> rigid;  // rows of RigidBodyTable
    std::span<const Index> node;   // rows of NodeTable; no_index where a rigid body has its rows
    FreedomMemory memory;
    ThroughGroups walk;
    LoadSums sums;
    Real scale;  // sqrt(J), of e_nat
    Real tolerance;
    Index base;

    FreedomOperator operator_for(const RegionStage& stage) const {
        return {memory, stage.settings.friction, scale, walk, stage.memory.newton, stage.memory.runs};
    }
};

/// As solve_push, in a region that has been solved and written to `stage.out`: also what the turn of capsules takes of
/// their distances (docs/methods/rigid_bodies.md 6.2). Velocities of the push are in region.memory.scratch afterwards.
bool push_freedom(const RegionStage& stage, const FreedomRegion& region, const FreedomOperator& op);

}  // namespace skerry
