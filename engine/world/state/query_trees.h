// Trees around the surfaces as they are now, for questions between steps. The boxes of BvhTable are those of the last
// search of each body, and belong to the step.
#pragma once

#include "components/bvh_table.h"
#include "components/column.h"

namespace skerry {

struct QueryTrees {
    Column<Aabb> box;             // m, by row of BvhTable
    Column<std::uint8_t> fitted;  // by body; empty: none is

    /// After nodes have moved, or rows.
    void forget() { fitted.clear(); }
};

}  // namespace skerry
