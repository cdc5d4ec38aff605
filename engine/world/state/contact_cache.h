// What is remembered of contacts from step to step: impulses to start from, contacts of what rests, close pairs and
// their candidates.
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "components/resting_contact_table.h"
#include "engine/world/state/model.h"

namespace skerry {

struct ContactCache {
    WarmStartTable warm_start;
    RestingContactTable resting;
    PairTable pairs;
    SearchState search;
    CrossingTable crossings;

    /// Forgets what is believed of distances: of a body and within it, which was moved by hand, or of a collider. All
    /// pairs of it are found and searched again in the next step, and no others.
    void forget_body(Model& model, std::size_t body);
    void forget_collider(const Model& model, std::size_t collider);
    /// Bodies and colliders have come, of which nothing is known.
    void extend(const Model& model);
};

}  // namespace skerry
