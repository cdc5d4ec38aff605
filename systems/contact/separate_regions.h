// Separation of the contacts into independent regions (methods.md 3).
#pragma once

#include "components/column.h"
#include "components/contact_table.h"
#include "components/options.h"
#include "components/region_table.h"
#include "jobs/executor.h"

namespace skerry {

/// One node of the union-find. The three fields are used together, at places all over the memory.
struct UnionNode {
    Index parent;
    std::uint32_t stamp;  // parent is of this step
    Index label;          // region of a root
};

/// Memory of the union-find, kept between steps.
struct UnionFind {
    Column<UnionNode> node;
    std::uint32_t now = 0;
};

/// Fills `regions.contacts` and `contact_region`. Two contacts are in one region if a chain of shared moving nodes (inverse mass > 0) joins
/// them. Regions are numbered by their first contact and hold their contacts in contact order; contacts without a moving node belong to
/// none. `mode` global puts all into one region; paper_algorithm_1 follows the paper to the letter, with its error (methods.md 3.1: areas
/// that share a node stay apart). Returns false when there are no contacts (skipped).
bool separate_regions(std::span<const Stencil> stencil, std::span<const Real> inverse_mass, ContactRegions mode, UnionFind& memory,
                      RegionTable& regions, std::span<Index> contact_region);

/// How many pairs of different regions share a moving node: 0 for a correct separation.
Index count_shared_nodes(std::span<const Stencil> stencil, std::span<const Real> inverse_mass, const RegionTable& regions);

}  // namespace skerry
