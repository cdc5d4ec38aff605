// Finds the contact regions of many contacts, with all workers in parallel (docs/methods/regions.md 3.1).
#pragma once

#include <array>

#include "components/column.h"
#include "components/contact_table.h"
#include "components/ragged.h"
#include "components/shared_union_find.h"
#include "jobs/executor.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// Working memory that is reused in later steps. A block is a range of consecutive contacts, which one task processes.
/// A region begins in the block that contains its first contact.
struct BlockLabels {
    SharedUnionFind sets;
    Column<Index> by_block;  // contacts, sorted by the block in which the region of a contact begins
    // Entry for each pair of blocks (a, b): index in `by_block` at which the next contact of block a whose region
    // begins in block b is to be stored.
    Column<Index> entry;
};

/// Writes the region of each contact and the contacts of each region, and returns the number of regions. Regions are
/// numbered in the order of their first contacts. Afterwards memory.sets holds the sets of connected moving nodes, and
/// the first contact of each set.
Index label_in_blocks(Executor& executor, std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                      const NodeGroups& groups, BlockLabels& memory, Ragged<Index>& contacts,
                      std::span<Index> contact_region);

}  // namespace skerry
