// Coloured order of a large region. It is reused as long as the moving nodes of the contacts do not change.
#pragma once

#include <span>

#include "jobs/team.h"
#include "systems/solver/coloured/by_colour.h"
#include "systems/solver/inputs/region_inputs.h"

namespace skerry {

/// Data of a large region that are stored from step to step.
struct ColouredRegion {
    Column<ContactNodes> moving;  // by contact: moving nodes as rows of NodeTable
    Column<ContactNodes> local;   // by contact: moving nodes as indices in `node`
    Column<Index> node;           // moving nodes of all contacts, each listed once: rows of NodeTable
    ColouredOrder order;
    ColouringMemory colouring;
    Column<BlockSum> partial;  // for each block of the coloured order: partial sums over the contacts of the block
    Column<std::uint8_t> same_nodes;  // by block of contacts: 1 if the moving nodes equal those of the last call

    ByColour traversal(Team& team) { return {order, team, partial.span()}; }
};

/// Returns the nodes that an impulse of contact `row` can move, in the order of the stencil.
ContactNodes moving_nodes(const RegionInputs& inputs, Index row);

/// Computes the coloured order of the contacts listed in `row`. If all contacts have the same moving nodes as in the
/// last call, as in a region at rest, the function keeps the old order and returns false. `node_number`: scratch memory
/// by row of NodeTable, with any contents.
bool order_region(const RegionInputs& inputs, std::span<const Index> row, Team& team, std::span<Index> node_number,
                  ColouredRegion& region);

}  // namespace skerry
