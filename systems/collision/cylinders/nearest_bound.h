// Lower bounds of the distance from a cylinder.
#pragma once

#include "systems/collision/colliders/face_contact.h"
#include "systems/collision/cylinders/cylinder_touches.h"

namespace skerry {

/// Lower bound of the distance of a triangle, given in the frame of the cylinder [m].
Real distance_bound(const ColliderGeometry& cylinder, const LocalFace& face);

/// Lower bound of the distance of a part of a shape at `place` in the frame of the cylinder [m]. It uses the axes of
/// both shapes and the normals of the touches as separating axes, and the bounding balls.
Real shape_distance_bound(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part,
                          const RigidMotion& place, const CylinderTouches& touches);

}  // namespace skerry
