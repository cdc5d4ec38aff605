// Coloured order of a large region, kept as long as the moving nodes of its contacts do not change.
#pragma once

#include <span>

#include "jobs/team.h"
#include "systems/solver/coloured/by_colour.h"
#include "systems/solver/inputs/region_inputs.h"

namespace skerry {

/// Data of a large region that are kept from step to step.
struct ColouredRegion {
    Column<ContactNodes> moving;  // by contact: its moving nodes as rows of NodeTable
    Column<ContactNodes> local;   // by contact: its moving nodes as rows of `node`
    Column<Index> node;           // rows of NodeTable
    ColouredOrder order;
    ColouringMemory colouring;
    Column<BlockSum> partial;         // by block of the order
    Column<std::uint8_t> same_nodes;  // by block of contacts: 1 if the moving nodes are those of the last call

    ByColour walk(Team& team) { return {order, team, partial.span()}; }
};

/// The nodes that an impulse of contact `row` can move, in the order of the stencil.
ContactNodes moving_nodes(const RegionInputs& inputs, Index row);

/// Orders the contacts `row`. `place` is scratch memory by row of NodeTable with any contents. Returns false if the
/// order of the last call is still valid and was kept, as for a region at rest.
bool order_region(const RegionInputs& inputs, std::span<const Index> row, Team& team, std::span<Index> place,
                  ColouredRegion& region);

}  // namespace skerry
