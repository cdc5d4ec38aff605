// Whether a point is within a body.
#pragma once

#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// How often the surface of a body goes round a point, in parts of the solid angle: 1 within, 0 outside; 2 where the
/// body overlaps itself. Jacobson, Kavan, Sorkine-Hornung 2013, Robust inside-outside segmentation using generalized
/// winding numbers, equation 5; all of its triangles are summed up.
Real winding_number(const CollisionInputs& inputs, Index body, const Vec3& point);

/// Whether the point is in no part of the body, however it is folded.
bool is_outside(const CollisionInputs& inputs, Index body, const Vec3& point);

}  // namespace skerry
