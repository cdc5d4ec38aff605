// Visual surfaces (drawn in place of bodies) that were bound to a mesh before a body with this mesh was added.
#pragma once

#include <memory>

#include "engine/mesh/visual/bound_visual.h"
#include "skerry/world.h"

namespace skerry {

/// Gives a body a visual surface that is bound to the mesh of this body; nullptr removes the surface of the body.
void set_bound_visual(World& world, BodyHandle body, std::shared_ptr<const BoundVisual> visual);

}  // namespace skerry
