// Upper bounds of the motion of bodies and colliders in the step that begins; see contact_reach.h, 2.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

struct BodyReach {
    Real in_frame;  // motion relative to the body's frame [m]
    Real in_world;  // motion relative to the world [m]
};

/// Distance by which a body may close a gap in this step. The sum for both bodies bounds the reach of a pair. The speed
/// of the body is that of its last motion, which check_state measured. `measure`: if true, the present surface
/// velocities count, too, for example for a body that has not moved yet. They always count for a moving mesh collider,
/// because its script may start the motion at any time.
BodyReach body_reach(const CollisionInputs& inputs, const CollisionSettings& settings, Index body, bool measure,
                     Real h);

/// Distance by which the relative motion of the frames of two bodies may close a gap in this step [m].
Real frame_reach(const CollisionInputs& inputs, Index first, Index second, Real h);

/// Distance by which a collider may close a gap in this step [m]. `extent`: largest distance from its origin to a point
/// of the collider that may touch a body [m].
Real collider_reach(const CollisionInputs& inputs, Index collider, Real extent, Real h);

}  // namespace skerry
