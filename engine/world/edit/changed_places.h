// Where something came, went or changed: what rests there may have lost what held it, or have something in it now.
#pragma once

#include <vector>

#include "components/bvh_table.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Places are those of the moment at which they are added.
class ChangedPlaces {
public:
    /// The box of a body, or of a mesh collider.
    void add_body(const Model& model, std::size_t body);
    /// That of a collider of any shape; `now`: s.
    void add_collider(const Model& model, std::size_t collider, Real now);
    bool empty() const { return boxes_.empty() && planes_.empty(); }
    /// Ends the rest of all bodies that are nearer to a place than a mean edge of theirs and the contact distances:
    /// whatever touches is. Costs a look at the surfaces of bodies that rest. Forgets the places.
    void wake_near(Model& model);

private:
    std::vector<Aabb> boxes_;
    std::vector<RigidMotion> planes_;
};

}  // namespace skerry
