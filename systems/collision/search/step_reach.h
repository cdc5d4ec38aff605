// How far bodies and colliders may have moved by the end of the step that begins; see contact_reach.h, 2.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

struct BodyReach {
    Real in_frame;  // in the body's frame [m]
    Real in_world;  // with the motion of the frame [m]
};

/// Share of a body in the closing of a gap in this step: half of a pair's reach. Its speed is that of its last motion,
/// which check_state measured. `measure`: the present surface velocities count, too, as for a body that has not moved
/// yet. They always count for a moving mesh collider, whose script may start it at any time.
BodyReach body_reach(const CollisionInputs& inputs, const CollisionSettings& settings, Index body, bool measure,
                     Real h);

/// Share of the relative motion of the frames of two bodies in the closing of a gap [m].
Real frame_reach(const CollisionInputs& inputs, Index first, Index second, Real h);

/// Share of a collider, whose relevant points are at most `extent` from its origin, in the closing of a gap [m].
Real collider_reach(const CollisionInputs& inputs, Index collider, Real extent, Real h);

}  // namespace skerry
