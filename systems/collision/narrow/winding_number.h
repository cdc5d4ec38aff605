// Test for whether a point is inside a body.
#pragma once

#include "systems/collision/inputs/collision_inputs.h"

namespace skerry {

/// Half of the solid angle of a triangle as seen from the origin; negative if the corners then appear counter-clockwise
/// (Van Oosterom, Strackee 1983, The solid angle of a plane triangle).
Real half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// Winding number of the surface of a body around a point: 1 inside, 0 outside, 2 in regions where the body overlaps
/// itself. The winding number is the sum of the solid angles of all triangles divided by 4 pi (Jacobson, Kavan,
/// Sorkine-Hornung 2013, Robust inside-outside segmentation using generalized winding numbers, equation 5).
Real winding_number(const CollisionInputs& inputs, Index body, const Vec3& point);

/// True if no part of the body contains the point: the winding number, an integer up to rounding, is 0. This is also
/// correct where the body overlaps itself.
bool is_outside(const CollisionInputs& inputs, Index body, const Vec3& point);

}  // namespace skerry
