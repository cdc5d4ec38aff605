// How near something can be to a cylinder, at most.
#pragma once

#include "systems/collision/colliders/face_contact.h"
#include "systems/collision/cylinders/cylinder_touches.h"

namespace skerry {

/// No point of a triangle in the frame of the cylinder is nearer, m.
Real distance_bound(const ColliderGeometry& cylinder, const LocalFace& face);

/// No point of a part of a shape at `place` in the frame of the cylinder is nearer, m: as the axes of both tell, the
/// planes of what touches, and the balls around.
Real shape_distance_bound(const ColliderGeometry& cylinder, const ColliderGeometry& other, Index part,
                          const RigidMotion& place, const CylinderTouches& touches);

}  // namespace skerry
