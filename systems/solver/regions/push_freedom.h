// Split impulse in regions with rigid bodies: moves overlapping bodies apart (docs/methods/contact.md 3.4).
#pragma once

#include "systems/solver/operators/freedom_operator.h"
#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// A region with its part of the memory. Order of the velocity rows: two per rigid body, then touched nodes of implicit
/// bodies, then nodes of clusters, then other nodes.
struct FreedomRegion {
    std::span<const Index> row;    // rows of ContactTable
    std::span<const Index> joint;  // rows of JointBlockTable; in the memory they follow the contacts
    std::span<const Index> rigid;  // rows of RigidBodyTable
    std::span<const Index> node;   // rows of NodeTable; no_index at the two rows of a rigid body
    FreedomMemory memory;
    ThroughGroups walk;
    LoadSums sums;
    Real scale;  // scale of e_nat [sqrt(J)]
    Real tolerance;
    Index base;

    FreedomOperator operator_for(const RegionStage& stage) const {
        return {memory, stage.settings.friction, scale, walk, stage.memory.newton, stage.memory.runs};
    }
};

/// Variant of solve_push for a region whose solution is already written to `stage.out`. It also compensates the gap
/// that capsules and cylinders lose by turning (docs/methods/rigid_bodies.md 6.2). The pseudo velocities are in
/// region.memory.scratch afterwards. Returns false if nothing is pushed.
bool push_freedom(const RegionStage& stage, const FreedomRegion& region, const FreedomOperator& op);

}  // namespace skerry
