// Places where objects were added, removed or changed. Sleeping bodies there may have lost their support or may now
// overlap an object.
#pragma once

#include <vector>

#include "components/bvh_table.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Places are stored as boxes and planes in world coordinates. If an object moves later, its place stays where it was.
class ChangedPlaces {
public:
    /// Adds the bounding box of a body, or of the body of a mesh collider.
    void add_body(const Model& model, std::size_t body);
    /// Adds the bounding box of a collider, or the plane of a plane collider. `now`: present time [s].
    void add_collider(const Model& model, std::size_t collider, Real now);
    bool empty() const { return boxes_.empty() && planes_.empty(); }
    /// Wakes all sleeping bodies whose distance from a place is less than their mean edge length plus the contact
    /// distances. Costs one pass over the surfaces of sleeping bodies. Clears the places.
    void wake_near(Model& model);

private:
    std::vector<Aabb> boxes_;
    std::vector<RigidMotion> planes_;
};

}  // namespace skerry
