// Upper bounds of the motion of bodies and colliders in the step that begins (contact_reach.h, 2).
#pragma once

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

struct BodyReach {
    Real in_frame;  // bound of the motion relative to the body's frame [m]
    Real in_world;  // bound of the motion relative to the world [m]
};

/// Distance by which a body may close a gap in this step, from its greatest speed in the last step (measured by
/// check_state). To bound the closing distance of two bodies, add their `in_world`, or their `in_frame` and
/// frame_reach(). The present velocities of the surface count, too:
/// - if `measure` is true, for example for a body that has not moved yet;
/// - always for a moving mesh collider, because its script may start the motion at any time.
BodyReach body_reach(const CollisionInputs& inputs, const CollisionSettings& settings, Index body, bool measure,
                     Real h);

/// Distance by which the relative motion of the two bodies' frames may close a gap in this step [m].
Real frame_reach(const CollisionInputs& inputs, Index first, Index second, Real h);

/// Distance by which a collider may close a gap in this step [m]. `extent`: distance from the origin of the collider to
/// its furthest point that may touch a body [m].
Real collider_reach(const CollisionInputs& inputs, Index collider, Real extent, Real h);

}  // namespace skerry
