// How far bodies and colliders may have come by the end of the step that begins; see contact_reach.h, 2.
#pragma once

#include "components/pair_table.h"
#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

struct BodyReach {
    Real in_frame;  // m
    Real in_world;  // m, with the motion of the frame
};

/// What a body may add to the closing of a gap in this step: half of a pair's reach. Its speed is that of its last
/// motion, which check_state measured. `measure`: the velocities of the surface themselves count, too (a body that has
/// not moved yet, or a mesh collider, whose script may start it at any time).
BodyReach body_reach(const CollisionInputs& inputs, const CollisionSettings& settings, Index body, bool measure,
                     Real h);

/// What the frames of two bodies may add, m.
Real frame_reach(const CollisionInputs& inputs, Index first, Index second, Real h);

/// The same of a collider whose points of interest are at most `extent` from its origin.
Real collider_reach(const CollisionInputs& inputs, Index collider, Real extent, Real h);

}  // namespace skerry
