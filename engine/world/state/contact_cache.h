// Contact data that are kept from step to step: warm-start impulses, contacts of sleeping bodies, pairs of close
// objects and their contact candidates.
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

    /// Makes the next step search all pairs of an object again. Must be called if the object was moved between steps,
    /// because stored distances are then no longer valid. The next step also tests whether a moved body is strained,
    /// and whether its tetrahedra are inverted.
    void forget_body(Model& model, std::size_t body);
    void forget_collider(const Model& model, std::size_t collider);
    /// Adds rows for new bodies and colliders. Their distances to other objects count as unknown until the next step
    /// has searched their pairs.
    void extend(const Model& model);
};

}  // namespace skerry
