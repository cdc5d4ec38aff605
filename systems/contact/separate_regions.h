// Separation of the contacts into independent regions (docs/methods/regions.md 1, 3).
#pragma once

#include "components/contact_table.h"
#include "components/options.h"
#include "components/region_table.h"
#include "components/union_find.h"
#include "jobs/executor.h"
#include "systems/contact/label_in_blocks.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// Working memory that is reused in later steps.
struct SeparationMemory {
    UnionFind sets;  // used for few contacts or few workers; in other cases `labels` is used
    BlockLabels labels;
};

/// Minimum number of contacts and of workers for separation in blocks; below it, regions are separated sequentially.
/// Separation in blocks needs 1.3 to 1.5 times the work of sequential separation, and five parallel phases. For 1,024
/// contacts it takes 65 us of work, which all workers share; sequential separation takes 50 us of one worker.
inline constexpr std::size_t least_contacts_in_blocks = 1024;
inline constexpr int least_workers_for_blocks = 4;

/// Divides contacts, joints and cables into regions: fills their lists in `regions`, and `contact_region`. With `mode`
/// global, there is one region. Returns false if there are no contacts, joints and cables (skipped).
///
/// Two contacts are in one region if a chain of shared moving nodes (inverse mass > 0) connects them:
/// - The nodes of one group in `groups` count as one node.
/// - Joints and cables connect nodes as contacts do.
/// - Contacts without a moving node belong to no region.
///
/// Regions are numbered in the order of their first contacts. Regions without contacts follow, in the order of their
/// first joints, then of their first cables. Each region lists its contacts, joints and cables in ascending order. The
/// result does not depend on the number of workers.
bool separate_regions(Executor& executor, std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                      const NodeGroups& groups, ContactRegions mode, SeparationMemory& memory, RegionTable& regions,
                      std::span<Index> contact_region);

}  // namespace skerry
