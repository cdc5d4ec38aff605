// Grouping of regions into tasks, and their order (docs/methods/regions.md 4). Predictions and history only change when
// a region is solved; they never change its result.
#pragma once

#include "components/column.h"
#include "components/region_table.h"
#include "jobs/executor.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/regions/region_memory.h"

namespace skerry {

/// Writes regions.id from the keys of the contacts and finds the effort of each region in the last step. Without keys
/// no history is available.
void recall_regions(Executor& executor, std::span<const ContactKey> key, RegionMemory& memory, RegionTable& regions);

/// Writes regions.order and groups it into tasks. Regions too large for lanes come first, by falling predicted cost.
/// Small regions follow by size, so that lanes fill; single contacts are last.
void schedule_regions(Executor& executor, const SolverSettings& settings, RegionMemory& memory, RegionTable& regions);

/// Records the effort of each region for the next step.
void remember_regions(RegionMemory& memory, const RegionTable& regions);

}  // namespace skerry
