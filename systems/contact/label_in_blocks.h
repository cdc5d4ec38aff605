// Finds the regions of many contacts with all workers (docs/methods/regions.md 3.1).
#pragma once

#include <array>

#include "components/column.h"
#include "components/contact_table.h"
#include "components/ragged.h"
#include "components/shared_union_find.h"
#include "jobs/executor.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// Working memory, kept between steps.
struct BlockLabels {
    SharedUnionFind sets;
    Column<Index> by_block;  // contacts, sorted by the block in which their region begins
    Column<Index> place;     // by pair of blocks: next position of a contact of one whose region begins in the other
};

/// Writes the region of each contact and the contacts of each region, and returns the number of regions. Regions are
/// numbered by their first contact. Afterwards the sets cover all moving nodes and hold their first contacts.
Index label_in_blocks(Executor& executor, std::span<const Stencil> stencil, std::span<const Real> inverse_mass,
                      const NodeGroups& groups, BlockLabels& memory, Ragged<Index>& contacts,
                      std::span<Index> contact_region);

}  // namespace skerry
