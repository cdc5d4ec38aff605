// What is remembered of contacts from step to step: impulses to start from, close pairs and their candidates.
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "engine/world/state/model.h"

namespace skerry {

struct ContactCache {
    WarmStartTable warm_start;
    PairTable pairs;
    SearchState search;
    CrossingTable crossings;

    /// Forgets what the search believes of distances.
    void search_afresh(Model& model);
    /// Rows have moved: pairs are found again. Impulses stay, since their keys name bodies by slot.
    void drop_pairs(Model& model);
};

}  // namespace skerry
