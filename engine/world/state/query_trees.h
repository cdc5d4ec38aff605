// Trees around the present surfaces, for queries between steps. The boxes of BvhTable belong to the step: they are
// those of the last search of each body.
#pragma once

#include "components/bvh_table.h"
#include "components/column.h"

namespace skerry {

struct QueryTrees {
    Column<Aabb> box;             // by row of BvhTable [m]
    Column<std::uint8_t> fitted;  // by body, whether its boxes are fitted; empty: none is

    /// To be called after nodes or rows have moved.
    void forget() { fitted.clear(); }
};

}  // namespace skerry
