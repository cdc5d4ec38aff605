// Bounding volume hierarchies around the present surfaces, for queries between steps. The boxes in BvhTable cannot be
// used, because they belong to the last contact search of each body.
#pragma once

#include "components/bvh_table.h"
#include "components/column.h"

namespace skerry {

struct QueryTrees {
    Column<Aabb> box;             // present bounding box of each row of BvhTable [m]
    Column<std::uint8_t> fitted;  // for each body, nonzero if its boxes fit its present surface; empty: no boxes fit

    /// Marks all boxes as out of date. Must be called after nodes or table rows have moved.
    void forget() { fitted.clear(); }
};

}  // namespace skerry
