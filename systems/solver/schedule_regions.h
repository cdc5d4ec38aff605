// Which regions are solved together, and in which order they are started (methods.md 3.3).
#pragma once

#include "components/column.h"
#include "components/region_table.h"
#include "systems/solver/solver_memory.h"

namespace skerry {

/// Writes regions.order (largest predicted cost first, ties by number) and packs it into tasks that are worth starting. The tasks do not
/// change what is computed, only when.
void schedule_regions(const SolverSettings& settings, RegionTable& regions, Column<RegionTask>& task);

}  // namespace skerry
