// Order in which regions are solved, and their grouping into tasks (docs/methods/regions.md 4). The cost of a region is
// predicted from its sweep counts in earlier steps. A prediction affects only when a region is solved, never its
// result.
#pragma once

#include "components/column.h"
#include "components/region_table.h"
#include "jobs/executor.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/regions/region_memory.h"

namespace skerry {

/// Writes regions.id from the keys of the contacts, and finds the number of sweeps that each region needed in earlier
/// steps. Without keys no region is recognised from earlier steps.
void recall_regions(Executor& executor, std::span<const ContactKey> key, RegionMemory& memory, RegionTable& regions);

/// Writes regions.order and groups the ordered regions into tasks. The order is
/// 1. regions too large for lanes (elements of SIMD registers, each of which solves one small region), by descending
///    predicted cost,
/// 2. small regions by descending size, so that regions of similar size share the registers; single contacts are last.
void schedule_regions(Executor& executor, const SolverSettings& settings, RegionMemory& memory, RegionTable& regions);

/// Updates the moving averages of the sweep counts with the sweeps of this step, for the next step.
void remember_regions(RegionMemory& memory, const RegionTable& regions);

}  // namespace skerry
