// Contact data that outlive a step: impulses for the warm start, contacts of resting bodies, close pairs and their
// candidates.
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

    /// Forgets all known distances of a body that was moved by hand (to others and within itself), or of a collider.
    /// All its pairs are found and searched again in the next step, and no others.
    void forget_body(Model& model, std::size_t body);
    void forget_collider(const Model& model, std::size_t collider);
    /// Adds rows for new bodies and colliders, about which nothing is known.
    void extend(const Model& model);
};

}  // namespace skerry
