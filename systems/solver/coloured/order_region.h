// The coloured order of a large region, kept as long as its contacts have the same moving nodes.
#pragma once

#include <span>

#include "jobs/team.h"
#include "systems/solver/coloured/by_colour.h"
#include "systems/solver/inputs/region_inputs.h"

namespace skerry {

/// What a large region keeps from step to step.
struct ColouredRegion {
    Column<ContactNodes> moving;  // by contact: rows of NodeTable
    Column<ContactNodes> local;   // by contact: the same as rows of `node`
    Column<Index> node;           // rows of NodeTable
    ColouredOrder order;
    ColouringMemory colouring;
    Column<BlockSum> partial;         // by block of the order
    Column<std::uint8_t> same_nodes;  // by block of contacts: whether they have the moving nodes of the last call

    ByColour walk(Team& team) { return {order, team, partial.span()}; }
};

/// The nodes that an impulse of contact `row` can move, in the order of the stencil.
ContactNodes moving_nodes(const RegionInputs& inputs, Index row);

/// Orders the contacts `row`. `place` is memory by row of NodeTable, its contents are of no matter. Returns false when
/// the order of the last call still holds and was kept: a region at rest is not coloured again.
bool order_region(const RegionInputs& inputs, std::span<const Index> row, Team& team, std::span<Index> place,
                  ColouredRegion& region);

}  // namespace skerry
