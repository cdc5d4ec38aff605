// Places of additions, removals and changes. Bodies asleep there may have lost their support or may now overlap.
#pragma once

#include <vector>

#include "components/bvh_table.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Each place is recorded as it is when it is added.
class ChangedPlaces {
public:
    /// Adds the box of a body, or of a mesh collider.
    void add_body(const Model& model, std::size_t body);
    /// Adds the box or plane of a collider of any shape. `now`: present time [s].
    void add_collider(const Model& model, std::size_t collider, Real now);
    bool empty() const { return boxes_.empty() && planes_.empty(); }
    /// Wakes all bodies that are nearer to a place than their mean edge plus the contact distances; this includes all
    /// that touch it. Costs a pass over the surfaces of sleeping bodies. Clears the places.
    void wake_near(Model& model);

private:
    std::vector<Aabb> boxes_;
    std::vector<RigidMotion> planes_;
};

}  // namespace skerry
