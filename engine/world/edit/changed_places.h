// Places where objects were added, removed or changed. Sleeping bodies there may have lost their support or may now
// overlap an object.
#pragma once

#include <vector>

#include "components/bvh_table.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Places are stored as boxes and planes in world coordinates. A stored place does not change if its object moves
/// later.
class ChangedPlaces {
public:
    /// Adds the bounding box of a body, or of the mesh of a mesh collider, enlarged by its contact distance.
    void add_body(const Model& model, std::size_t body);
    /// Adds the bounding box of a collider, or the plane of a plane collider. `now`: present time [s].
    void add_collider(const Model& model, std::size_t collider, Real now);
    bool empty() const { return boxes_.empty() && planes_.empty(); }
    /// Wakes all sleeping bodies that are closer to a place than their mean edge length plus the contact distances, in
    /// one pass over their surfaces. Then empties the list of places.
    void wake_near(Model& model);

private:
    std::vector<Aabb> boxes_;
    std::vector<RigidMotion> planes_;
};

}  // namespace skerry
