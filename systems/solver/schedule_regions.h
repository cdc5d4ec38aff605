// Which regions are solved together, and in which order they are started (docs/methods/regions.md 4). What is predicted
// and remembered here changes when a region is solved, never what comes out.
#pragma once

#include "components/column.h"
#include "components/region_table.h"
#include "jobs/executor.h"
#include "systems/solver/inputs/solver_settings.h"
#include "systems/solver/regions/region_memory.h"

namespace skerry {

/// Writes regions.id from the keys of the contacts, and finds what each region needed in the last step. Without keys
/// nothing is known.
void recall_regions(Executor& executor, std::span<const ContactKey> key, RegionMemory& memory, RegionTable& regions);

/// Writes regions.order and packs it into tasks that are worth starting: regions that do not fit into lanes one by one,
/// largest predicted cost first; small ones by size, so that lanes fill; then single contacts.
void schedule_regions(Executor& executor, const SolverSettings& settings, RegionMemory& memory, RegionTable& regions);

/// Notes what each region needed, for the next step.
void remember_regions(RegionMemory& memory, const RegionTable& regions);

}  // namespace skerry
