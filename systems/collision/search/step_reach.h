// Upper bounds of the motion of bodies and colliders in the step that begins (contact_reach.h, 2).
#pragma once

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

struct BodyReach {
    Real in_frame;  // bound of the motion relative to the body's frame [m]
    Real in_world;  // bound of the motion relative to the world [m]
};

/// Distance by which a body may close a gap in this step. To bound the closing distance of two bodies, add their
/// `in_world`, or their `in_frame` and frame_reach(). The bound is computed from the greatest speed in the last step,
/// which check_state has measured. If `measure` is true, the present velocities of the surface are taken into account,
/// too, for example for a body that has not moved yet. They are always taken into account for a moving mesh collider,
/// because its script may start the motion at any time.
BodyReach body_reach(const CollisionInputs& inputs, const CollisionSettings& settings, Index body, bool measure,
                     Real h);

/// Distance by which the relative motion of the two bodies' frames may close a gap in this step [m].
Real frame_reach(const CollisionInputs& inputs, Index first, Index second, Real h);

/// Distance by which a collider may close a gap in this step [m]. `extent`: distance from the origin of the collider to
/// its furthest point that may touch a body [m].
Real collider_reach(const CollisionInputs& inputs, Index collider, Real extent, Real h);

}  // namespace skerry
