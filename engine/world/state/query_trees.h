// Bounding volume hierarchies around the present surfaces, for ray casts and nearest points between steps. The boxes in
// BvhTable cannot be used, because they bound each body as it was at its last contact search.
#pragma once

#include "components/bvh_table.h"
#include "components/column.h"

namespace skerry {

struct QueryTrees {
    Column<Aabb> box;             // present bounding box of each row of BvhTable [m]
    Column<std::uint8_t> fitted;  // for each body, nonzero if its boxes bound its present surface; empty: none do

    /// Marks all boxes as out of date. Must be called after nodes or table rows have moved.
    void forget() { fitted.clear(); }
};

}  // namespace skerry
