// Contact data that are used in more than one step: warm-start impulses, contacts of sleeping bodies, close pairs and
// their contact candidates.
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

    /// Must be called for an object that was moved between steps. Its distances to other objects, and those between
    /// parts of a moved body, count as unknown until the next step has searched its pairs. Other pairs are not searched
    /// again. A moved body also loses its marks as unstrained and not inverted.
    void forget_body(Model& model, std::size_t body);
    void forget_collider(const Model& model, std::size_t collider);
    /// Adds rows for new bodies and colliders, whose distances to other objects are still unknown.
    void extend(const Model& model);
};

}  // namespace skerry
