// Anchors (points fixed to an object, such as the ends of springs): conversion between the form that users give and the
// form that tables store.
#pragma once

#include <cstddef>
#include <string>

#include "components/anchor.h"
#include "engine/world/world_state.h"
#include "skerry/anchor.h"
#include "systems/forces/anchors.h"

namespace skerry {

/// An anchor in the form that tables store.
struct PlacedAnchor {
    Index body = no_index, collider = no_index;  // rows of BodyTable and ColliderTable
    AnchorRow point;

    void store(AnchorColumns& columns, std::size_t row) const;
};

/// Fixes an anchor to its body or collider at the present time. Throws SceneError if a handle is stale, the point is
/// not finite, or the point is too far from a deformable body. `object` and `field`: names of the object and of its
/// field, for the message.
PlacedAnchor place_anchor(WorldState& world, const Anchor& anchor, const std::string& object, const std::string& field);

/// Returns the name of the object to which an anchor is fixed, for messages: "body 'NAME'", "collider 'NAME'" or "the
/// world". `body` and `collider`: rows of BodyTable and ColliderTable, or no_index.
std::string title_of_end(const Model& model, Index body, Index collider);
std::string title_of_end(const Model& model, const Anchor& anchor);

/// Computes positions and velocities of anchors between steps. An object of this class is valid until the world
/// changes. The velocities of colliders are mean values over the last step, like the velocities of nodes.
class AnchorsBetweenSteps {
public:
    explicit AnchorsBetweenSteps(const WorldState& world);
    AnchorInputs of(const AnchorColumns& columns) const;
    /// Returns an anchor as users give it: with handles, at its present position in the world.
    Anchor at(const AnchorColumns& columns, std::size_t row) const;

private:
    const Model& model_;
    Column<RigidMotion> motion_;  // motions of all colliders, by row of ColliderTable
};

}  // namespace skerry
