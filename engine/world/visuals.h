// Visual surfaces: surfaces that are drawn in place of bodies and move with their nodes.
#pragma once

#include <memory>

#include "engine/mesh/visual/bound_visual.h"
#include "skerry/world.h"

namespace skerry {

/// Gives a body a visual surface that was bound to its mesh earlier (bind_visual). nullptr removes the visual surface.
void set_bound_visual(World& world, BodyHandle body, std::shared_ptr<const BoundVisual> visual);

}  // namespace skerry
