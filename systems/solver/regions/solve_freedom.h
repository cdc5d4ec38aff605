// Solver of regions whose contacts touch rigid bodies (docs/methods/rigid_bodies.md 3).
#pragma once

#include "systems/solver/regions/life_cycle.h"

namespace skerry {

/// Solves one such region in one thread. `joints`: rows of JointBlockTable. A region with joints is solved by
/// accelerated sweeps whatever the method, because only sweeps support joints.
RegionOutcome solve_freedom(const RegionStage& stage, std::span<const Index> row, std::span<const Index> joints,
                            Index number, Index base);

}  // namespace skerry
